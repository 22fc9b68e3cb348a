use raywright::math::{DVec3, Ray};
use raywright::scene::cameras::{Body, Camera, CameraConnection, CameraRay, Spread, Viewpoint};
use std::f64::consts::{PI, TAU};

/// A camera inside a cylinder of radius 1 about its up axis, unrolled: columns are angles, rows are heights.
#[derive(Debug)]
struct Cylindrical {
    body: Body,
    /// The height of the picture's upper edge on the cylinder.
    top: f64,
}

impl Camera for Cylindrical {
    fn body(&self) -> &Body {
        &self.body
    }

    fn ray(&self, [x, y]: [f64; 2], _lens: [f64; 2], time: f64) -> CameraRay {
        let [width, height] = self.body.size();
        let from = self.body.at(time);
        let (sin, cos) = (TAU * (x / width - 0.5)).sin_cos();
        let direction = from.direction(sin, self.top * (1.0 - 2.0 * y / height), cos).normalize();
        let ray = Ray { time: self.body.scene_time(time), ..Ray::new(from.position, direction) };
        CameraRay { ray, weight: 1.0 }
    }

    // The inverse of `ray`, for paths that start at a light.
    fn connect(&self, point: DVec3, _lens: [f64; 2], time: f64) -> Option<CameraConnection> {
        let ([width, height], from) = (self.body.size(), self.body.at(time));
        let way = point - from.position;
        let [right, up, forward] = [from.right, from.up, from.forward].map(|axis| way.dot(axis));
        let level = right.hypot(forward);
        let at = up / level;
        let film = [width * (0.5 + right.atan2(forward) / TAU), 0.5 * height * (1.0 - at / self.top)];
        // Area on the cylinder is foreshortened, and farther from the camera than the axis is from the cylinder.
        let density = width * height / (2.0 * TAU * self.top) * way.length() / level.powi(3);
        (at.abs() <= self.top && density.is_finite()).then_some(CameraConnection {
            film,
            origin: from.position,
            density,
        })
    }

    // Between pixels in the middle, for textures that are averaged over them.
    fn spread(&self) -> Spread {
        let [width, height] = self.body.size();
        Spread { angle: (TAU / width * (2.0 * self.top / height)).sqrt(), width: 0.0 }
    }
}

#[test]
fn a_point_is_seen_where_its_ray_came_from() {
    let viewpoint = Viewpoint::look_at(DVec3::ONE, DVec3::new(4.0, 0.0, 2.0), DVec3::Z).unwrap();
    let camera = Cylindrical { body: Body::new(viewpoint, 80, 40).unwrap(), top: 0.5 * PI };
    let seen = |x, y| camera.ray([x, y], [0.5; 2], 0.0).ray;
    for film in [[40.0, 20.0], [3.5, 1.25], [77.0, 39.0], [55.5, 30.0]] {
        let (ray, [x, y], step) = (seen(film[0], film[1]), film, 1e-4);
        let connection = camera.connect(ray.at(3.0), [0.5; 2], 0.0).unwrap();
        assert!((0..2).all(|i| (connection.film[i] - film[i]).abs() < 1e-9), "{:?}", connection.film);
        // A small square of the film covers so much of a sphere of radius 3.
        let across = seen(x + step, y).direction - seen(x - step, y).direction;
        let down = seen(x, y + step).direction - seen(x, y - step).direction;
        let area = 9.0 * across.cross(down).length() / (4.0 * step * step);
        assert!((area * connection.density - 1.0).abs() < 1e-6);
    }
    assert_eq!(camera.connect(DVec3::new(1.0, 1.0, 9.0), [0.5; 2], 0.0), None);
}
