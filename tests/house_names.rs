//! Names of types: one concept has one name, and a name with three meanings has none.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::house::{code, rust_files, without_tests};

/// Names that every room may have: a tree's node, and the options of a builder.
const COMMON: [&str; 2] = ["Node", "Options"];

#[test]
fn no_type_name_stands_three_times() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("rust");
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut tests = Vec::new();
    for path in rust_files(&root) {
        let (text, modules) = without_tests(&code(&fs::read_to_string(&path).unwrap()));
        let folder = match path.file_stem().unwrap().to_str() {
            Some("mod" | "lib") => path.parent().unwrap().to_owned(),
            _ => path.with_extension(""),
        };
        tests.extend(modules.into_iter().map(|name| folder.join(name)));
        let place = path.strip_prefix(&root).unwrap().display().to_string();
        for name in type_names(&text) {
            places.entry(name).or_default().push(place.clone());
        }
    }
    for files in places.values_mut() {
        files.retain(|file| !tests.iter().any(|test| root.join(file).with_extension("").starts_with(test)));
    }
    assert!(places.len() > 500, "too few types: {}", places.len());
    let told: String = places
        .iter()
        .filter(|(name, files)| !COMMON.contains(&name.as_str()) && files.len() > 2)
        .map(|(name, files)| format!("  {name}, {} times: {}\n", files.len(), files.join(", ")))
        .collect();
    assert!(told.is_empty(), "names of types that stand too often; take the field's term for the newest:\n{told}");
}

#[test]
fn type_names_are_seen_where_they_are_defined() {
    let text = "pub(super) struct Ray<T>(T);\nenum Side {\n    Left,\n}\npub trait Shape {\n    type Output;\n}\n\
        type Row = u32;\nimpl Shape for Ray<u32> {\n    type Output = Side;\n}\nfn f() {\n    struct Inner;\n}\n";
    assert_eq!(type_names(text), ["Ray", "Side", "Shape", "Row", "Inner"]);
}

/// The types that formatted code defines, but for those that belong to a trait.
fn type_names(code: &str) -> Vec<String> {
    let name_of = |line: &str| {
        let mut words = line.trim_start().split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|w| !w.is_empty());
        let mut word = words.next()?;
        while ["pub", "crate", "super", "in", "unsafe"].contains(&word) {
            word = words.next()?;
        }
        let is_type = ["struct", "enum", "trait", "union"].contains(&word) || word == "type" && !line.starts_with(' ');
        words.next().filter(|name| is_type && name.starts_with(char::is_uppercase)).map(String::from)
    };
    code.lines().filter_map(name_of).collect()
}
