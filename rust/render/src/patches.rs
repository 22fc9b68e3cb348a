//! Tests of patches of pixels that take samples together, through all operations on a picture.

use super::{Quiet, Rendering, Request, Settings, Until, render};
use raywright_integrators::{Integrator, Path};
use raywright_scene::Camera;
use raywright_scene::fixtures::cornell;

/// Patches are cut at two borders.
const SIZE: [u32; 2] = [21, 13];

const PATCHES: [u32; 3] = [2, 4, 8];

fn path(reuse: u32) -> Path {
    Path { reuse, ..Path::default() }
}

fn settings(samples: u32, threads: usize, adaptive: bool) -> Settings {
    let until = Until { samples: Some(samples), ..Until::default() };
    Settings { until, threads: Some(threads), adaptive, seed: 6, ..Settings::default() }
}

fn picture(reuse: u32, settings: &Settings) -> Rendering {
    let (scene, camera) = cornell(SIZE[0], SIZE[1]);
    render(&scene, &camera, &path(reuse), settings, &mut Quiet).unwrap()
}

#[test]
fn threads_tiles_and_passes_change_no_bit() {
    for (reuse, adaptive) in PATCHES.into_iter().flat_map(|reuse| [(reuse, false), (reuse, true)]) {
        let one = picture(reuse, &settings(37, 1, adaptive));
        for threads in [2, 5] {
            let other = picture(reuse, &settings(37, threads, adaptive));
            assert_eq!((other.rgb(), other.error), (one.rgb(), one.error));
            assert_eq!(other.standard_error(), one.standard_error());
            assert_eq!(other.film.counts(), one.film.counts());
        }
        let until = Until { seconds: Some(0.05), ..Until::default() };
        let timed = picture(reuse, &Settings { until, ..settings(0, 2, adaptive) });
        let again = picture(reuse, &settings(timed.film.samples(), 1, adaptive));
        assert_eq!(again.film.means(), timed.film.means());
    }
}

#[test]
fn tiles_go_by_the_picture_alone() {
    let (_, camera) = cornell(600, 300);
    for reuse in PATCHES {
        let sides = [1, 2, 64].map(|threads| settings(1, threads, false).film(&camera, threads, reuse).side());
        assert_eq!(sides, [32; 3]);
        assert_eq!(settings(1, 1, false).film(&cornell(SIZE[0], SIZE[1]).1, 1, reuse).side(), 4 * reuse);
    }
}

#[test]
fn pixels_of_a_patch_have_as_many_samples() {
    for reuse in PATCHES {
        let counts = picture(reuse, &settings(90, 2, true)).film.counts();
        let at = |x: u32, y: u32| counts[(y * SIZE[0] + x) as usize];
        let mut kinds = Vec::new();
        for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
            assert_eq!(at(x, y), at(x / reuse * reuse, y / reuse * reuse));
            kinds.push(at(x, y));
        }
        kinds.sort_unstable();
        kinds.dedup();
        assert!(kinds.len() > 3, "{kinds:?}");
        let all: u32 = counts.iter().sum();
        // Patches are few, and their counts are rounded.
        assert!((f64::from(all) / (21.0 * 13.0 * 90.0) - 1.0).abs() < 0.02, "{all}");
    }
}

#[test]
fn bytes_and_parts_make_the_same_picture() {
    let (scene, camera) = cornell(SIZE[0], SIZE[1]);
    for adaptive in [false, true] {
        let settings = settings(72, 2, adaptive);
        let whole = picture(4, &settings);
        let path = path(4);
        let mut rendering = Rendering::new(settings.film(&camera, 2, path.patch(&scene)));
        loop {
            let done = rendering.film.samples();
            let aim = rendering.next_aim(&settings.until, done, 0.0, 0.0);
            if aim == done {
                break;
            }
            rendering.begin(aim);
            let alone = rendering.film.appends() && done.is_multiple_of(rendering.film.block());
            for tile in (0..rendering.film.tile_count()).rev() {
                let request = rendering.request(tile..tile + 1, alone.then_some(done), aim);
                let request = Request::from_bytes(&request, SIZE[0], SIZE[1]).unwrap();
                rendering.take(&request.expose(&scene, &camera, &path, &settings, &mut Quiet).unwrap()).unwrap();
            }
            rendering.end(0.0);
            let bytes = rendering.to_bytes();
            let read =
                |patch| Rendering::from_bytes(&bytes, camera.width(), camera.height(), 1, adaptive, None, patch, false);
            rendering = read(4).unwrap();
            assert!(read(64).is_err());
        }
        assert_eq!((&rendering.film, rendering.error), (&whole.film, whole.error));
    }
}

#[test]
fn patches_of_one_are_pixels() {
    for adaptive in [false, true] {
        let (scene, camera) = cornell(SIZE[0], SIZE[1]);
        let settings = settings(37, 2, adaptive);
        // Integrators that share nothing in a scene give the bits of those that never share.
        let still = Path { max_depth: Some(1), ..path(8) };
        let a = render(&scene, &camera, &still, &settings, &mut Quiet).unwrap();
        let b = render(&scene, &camera, &Path { reuse: 1, ..still }, &settings, &mut Quiet).unwrap();
        assert_eq!((&a.film, a.error), (&b.film, b.error));
        assert_eq!(a.film.patch(), 1);
    }
}
