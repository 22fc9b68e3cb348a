//! The examples of `docs/extending.md`, compiled and tested; `nox -s outside` does so in a crate outside the tree.

mod accelerator;
mod camera;
mod integrator;
mod light;
mod material;
mod medium;
mod sampler;
mod shape;
mod texture;

/// The Rust of the page, block by block.
fn blocks(page: &str) -> Vec<String> {
    let fences = page.split("```rust\n").skip(1);
    fences.map(|rest| rest.split("```").next().unwrap_or_default().to_owned()).collect()
}

#[test]
fn the_page_on_extending_shows_what_is_compiled() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/extending.md");
    let shown = blocks(&std::fs::read_to_string(path).unwrap());
    let compiled = [
        include_str!("shape.rs"),
        include_str!("material.rs"),
        include_str!("light.rs"),
        include_str!("texture.rs"),
        include_str!("medium.rs"),
        include_str!("camera.rs"),
        include_str!("integrator.rs"),
        include_str!("sampler.rs"),
        include_str!("accelerator.rs"),
    ];
    assert_eq!(shown, compiled);
}
