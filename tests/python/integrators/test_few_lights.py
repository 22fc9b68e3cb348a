"""Where few lights shine on what is glossy, each is asked."""

import raywright as rw


def test_lamps_on_plates_leave_a_third_of_the_error_at_most():
    # Asking one lamp of five, chosen by where they are, left a relMSE of 0.0216 to 0.0227 with seeds 0 to 3.
    # Asking each leaves 0.0023 to 0.0035, so that luck would have to be three times the spread of seeds.
    scene, camera = rw.scenes.veach_plates(96, 96)
    path = rw.Path(max_depth=1)
    image = rw.render(scene, camera, path, samples=64, sampler=rw.rendering.Sobol(), progress=False)
    assert float(image.error) < 0.0216 / 3


def test_the_plan_tells_where_each_is_asked():
    lamps = [rw.Sphere((x, 3, 0), 0.1, emission=5.0) for x in range(17)]
    glossy, matt = (
        rw.Sphere((0, 0, 0), 1, material=m) for m in (rw.Conductor("Au", alpha=0.1), rw.Diffuse(0.5))
    )
    for shapes, lights, needed in (
        ([glossy, *lamps[:2]], (), True),
        ([glossy, *lamps[:16]], (), True),
        ([glossy, *lamps], (), False),
        ([glossy, lamps[0]], (), False),
        ([glossy, lamps[0]], (rw.PointLight((0, 3, 0), 1.0),), True),
        ([matt, *lamps[:2]], (), False),
    ):
        assert ("few lights" in rw.Scene(shapes, lights=lights).plan().needed) == needed
