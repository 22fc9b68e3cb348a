//! Module dependencies as in `ARCHITECTURE.md`, parsed from the source files. Cargo enforces the order of the floors,
//! since each is a crate.
//!
//! A dependency leads from a file that uses an item to the file that defines it, through all re-exports; tests are
//! ignored. A `mod.rs` and the files and folders beside it form one module: they may use items of their `mod.rs` and be
//! used there. Among these files and folders, each with its contents, dependencies must not be cyclic.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Lowest crate, whose folders correspond to the other crates.
const BASE: &str = "base";

/// Path segments from the crate to a module or to an item in it.
type Names = Vec<String>;

/// The dependencies of a file without its tests.
#[derive(Default)]
struct File {
    /// Paths used, relative to the crate.
    paths: BTreeSet<Names>,
    /// Imported names and their paths.
    imports: BTreeMap<String, Names>,
}

/// A dependency: an item of one file, used in another.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Arrow {
    from: Names,
    to: Names,
    item: String,
}

#[test]
fn no_two_files_or_folders_side_by_side_need_each_other() {
    let arrows = arrows(&crate_files());
    let circles = circles(&arrows);
    assert!(circles.is_empty(), "arrows that are part of a circle:\n{}", told(&circles));
}

#[test]
fn arrows_are_seen_however_they_are_written() {
    let texts = [
        ("mod.rs", "mod a;\nmod b;\npub mod c;\npub use a::{Big, Small as Little};\n"),
        ("a.rs", "/// See [`super::b::Far`].\npub struct Big<'a>(&'a str, super::c::d::Deep);\n"),
        (
            "b.rs",
            "use super::{\n    Little,\n    c::{self, d},\n};\nconst SIGNS: [char; 2] = ['\"', '{'];\n\
             fn f() -> d::Deep {\n    c::g()\n}\n",
        ),
        ("c/mod.rs", "pub mod d;\nmod e;\nuse e::E;\nfn text() -> &'static str {\n    \"crate::b::Far // \\\" \"\n}\n"),
        ("c/d.rs", "pub struct Deep;\n\n#[cfg(test)]\nmod tests {\n    use crate::b::Far;\n}\n"),
        ("base/src/f.rs", "use crate::a::Big;\n"),
        ("top/src/lib.rs", "mod g;\npub use g::G;\n"),
        ("top/src/g.rs", "use raywright_base::{b, c::d::Deep};\npub struct G(crate::h::H);\n"),
        ("top/src/h.rs", "pub struct H(raywright::a::Big);\n"),
        (
            "c/e.rs",
            "pub(super) struct E(super::d::Deep);\nmod inner {\n    use super::super::super::Big;\n}\n\
             #[cfg(test)]\nuse crate::b;\n",
        ),
    ];
    let files = files(texts.map(|(path, text)| (PathBuf::from(path), text.to_string())));
    let seen = arrows(&files);
    let told = told(&seen.iter().collect::<Vec<_>>());
    let expected = [
        "a -> c::d: Deep",
        "b -> a: Small",
        "b -> c: g",
        "b -> c: itself",
        "b -> c::d: Deep",
        "b -> c::d: itself",
        "c::e -> a: Big",
        "c::e -> c::d: Deep",
        "f -> a: Big",
        "top::g -> b: itself",
        "top::g -> c::d: Deep",
        "top::g -> top::h: H",
        "top::h -> a: Big",
    ];
    assert_eq!(told.lines().map(str::trim).collect::<Vec<_>>(), expected);
    let circles: Vec<String> = circles(&seen).iter().map(|a| a.from.join("::")).collect();
    assert_eq!(circles, ["a", "c::e"]);
}

#[test]
fn no_attribute_stands_twice() {
    for path in rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("rust")) {
        let text = fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        for (number, pair) in (1..).zip(lines.windows(2)) {
            let is_twice = pair[0] == pair[1] && pair[0].trim().starts_with("#[");
            assert!(!is_twice, "{}:{number}: {} stands twice", path.display(), pair[0].trim());
        }
    }
}

#[test]
fn no_line_is_longer_than_120_columns() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for path in ["rust", "tests", "benches"].iter().flat_map(|folder| rust_files(&root.join(folder))) {
        for (number, line) in (1..).zip(fs::read_to_string(&path).unwrap().lines()) {
            let columns = line.chars().count();
            assert!(columns <= 120, "{}:{number}: {columns} columns", path.display());
        }
    }
}

/// Return the dependencies that are part of a cycle between siblings.
fn circles(arrows: &BTreeSet<Arrow>) -> Vec<&Arrow> {
    // The siblings at both ends, by name.
    let ends = |arrow: &Arrow| {
        let shared = arrow.from.iter().zip(&arrow.to).take_while(|(a, b)| a == b).count();
        (arrow.from[..shared].to_vec(), arrow.from[shared].clone(), arrow.to[shared].clone())
    };
    let mut needs: BTreeMap<(Names, String), BTreeSet<String>> = BTreeMap::new();
    for (place, from, to) in arrows.iter().map(ends) {
        needs.entry((place, from)).or_default().insert(to);
    }
    let needs_it = |place: &Names, one: &String, other: &String| {
        let (mut reached, mut open) = (BTreeSet::new(), vec![one]);
        while let Some(next) = open.pop() {
            open.extend(
                needs.get(&(place.clone(), next.clone())).into_iter().flatten().filter(|to| reached.insert(*to)),
            );
        }
        reached.contains(other)
    };
    arrows.iter().filter(|arrow| matches!(ends(arrow), (place, from, to) if needs_it(&place, &to, &from))).collect()
}

/// Format one line per dependency.
fn told(arrows: &[&Arrow]) -> String {
    arrows.iter().map(|a| format!("  {} -> {}: {}\n", a.from.join("::"), a.to.join("::"), a.item)).collect()
}

/// Return all dependencies between files, except those between a `mod.rs` and its siblings.
fn arrows(files: &BTreeMap<Names, File>) -> BTreeSet<Arrow> {
    let mut arrows = BTreeSet::new();
    for (from, file) in files {
        for path in &file.paths {
            let (to, item) = stands(files, path);
            if !to.starts_with(from) && !from.starts_with(&to) {
                arrows.insert(Arrow { from: from.clone(), to, item });
            }
        }
    }
    arrows
}

/// Return the file that defines the item of a path, and the item's name; the name is empty for the file itself.
fn stands(files: &BTreeMap<Names, File>, path: &[String]) -> (Names, String) {
    let mut path = path.to_vec();
    // One step per re-export.
    for _ in 0..10 {
        let depth = (0..=path.len()).rev().find(|&n| files.contains_key(&path[..n])).expect("the crate itself is one");
        let (module, rest) = path.split_at(depth);
        match rest.first().and_then(|name| files[module].imports.get(name)) {
            Some(import) if *import != path => path = [import, &rest[1..]].concat(),
            _ => return (module.to_vec(), rest.first().cloned().unwrap_or("itself".into())),
        }
    }
    panic!("{} leads nowhere", path.join("::"));
}

/// Return all source files of the crate except tests, by module path.
fn crate_files() -> BTreeMap<Names, File> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("rust");
    let read = |path: PathBuf| (path.strip_prefix(&root).unwrap().to_owned(), fs::read_to_string(&path).unwrap());
    let files = files(rust_files(&root).into_iter().filter(|path| *path != root.join("lib.rs")).map(read));
    assert!(files.len() > 300, "too few files: {}", files.len());
    files
}

/// Return the source files except tests, by module path, from their paths and texts.
fn files(all: impl IntoIterator<Item = (PathBuf, String)>) -> BTreeMap<Names, File> {
    let (mut codes, mut tests) = (BTreeMap::new(), BTreeSet::new());
    for (path, text) in all {
        let mut module: Names = path.with_extension("").iter().map(|name| name.to_str().unwrap().into()).collect();
        module.pop_if(|name| name == "mod" || name == "lib");
        // Each file of a crate is a module of it; the lowest crate has no name of its own.
        let mut root = Names::new();
        if module.get(1).is_some_and(|folder| folder == "src") {
            module.remove(1);
            if module[0] == BASE {
                module.remove(0);
            } else {
                root.push(module[0].clone());
            }
        }
        let (code, modules) = without_tests(&code(&text));
        tests.extend(modules.into_iter().map(|name| [&*module, &[name]].concat()));
        codes.insert(module, (root, code));
    }
    codes.retain(|module, _| !tests.iter().any(|test| module.starts_with(test)));
    let known: BTreeSet<Names> = codes.keys().cloned().collect();
    codes.into_iter().map(|(module, (root, code))| (module.clone(), file(&module, &root, &code, &known))).collect()
}

/// Return all Rust files in a folder, recursively.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display())) {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    files
}

/// Return the text without comments and string contents.
pub fn code(text: &str) -> String {
    let mut code = String::new();
    let mut in_string = false;
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let skipped = match c {
            '\\' if in_string => 2,
            '"' => {
                in_string = !in_string;
                1
            }
            '\'' if !in_string && rest.starts_with("'\"'") => 3,
            '/' if !in_string && rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            _ => 0,
        };
        if skipped == 0 {
            if !in_string || c == '\n' {
                code.push(c);
            }
            rest = &rest[c.len_utf8()..];
        } else {
            rest = &rest[skipped..];
        }
    }
    code
}

/// Return formatted code without test items, and the names of test files.
pub fn without_tests(code: &str) -> (String, Vec<String>) {
    let (mut kept, mut files) = (String::new(), Vec::new());
    let mut lines = code.lines();
    while let Some(line) = lines.next() {
        let Some(indent) = line.find("#[cfg(test)]") else {
            kept.extend([line, "\n"]);
            continue;
        };
        // An item ends with the first line of equal indentation that closes a delimiter.
        for line in lines.by_ref() {
            let (before, item) = line.split_at(indent.min(line.len()));
            if before.trim().is_empty() && !item.starts_with(' ') && item.trim_end().ends_with([';', '}']) {
                let name = item.trim_end().strip_suffix(';').and_then(|item| item.split("mod ").nth(1));
                files.extend(name.map(String::from));
                break;
            }
        }
    }
    (kept, files)
}

/// Return the dependencies of the code in a module, in a crate with this root.
fn file(module: &Names, root: &Names, code: &str, known: &BTreeSet<Names>) -> File {
    let words = words(code);
    let word = |at: usize| words.get(at).map_or("", String::as_str);
    let mut file = File::default();
    // Modules within the file, each with the number of open braces inside it.
    let mut inner: Vec<(String, usize)> = Vec::new();
    let mut open = 0;
    // Imports come first, as paths may start with an imported name.
    for imports in [true, false] {
        let mut at = 0;
        while at < words.len() {
            let here: Names = module.iter().chain(inner.iter().map(|(name, _)| name)).cloned().collect();
            at += 1;
            match word(at - 1) {
                "mod" if word(at + 1) == "{" => {
                    inner.push((words[at].clone(), open + 1));
                }
                "{" => open += 1,
                "}" => {
                    inner.pop_if(|(_, inside)| *inside == open);
                    open -= 1;
                }
                "use" => {
                    let mut leaves = Vec::new();
                    tree(&words, &mut at, &[], &mut leaves);
                    for (path, name) in leaves.into_iter().filter(|_| imports) {
                        let Some(path) = from_crate(&path, (root, &here), &file, known) else { continue };
                        assert!(name != "*", "{} takes all of {}: nobody sees what", here.join("::"), path.join("::"));
                        file.paths.insert(path.clone());
                        if inner.is_empty() {
                            file.imports.insert(name, path);
                        }
                    }
                }
                name if !imports && word(at) == "::" && (at < 2 || word(at - 2) != "::") => {
                    let mut path = vec![name.to_string()];
                    while word(at) == "::" && word(at + 1).starts_with(|c: char| c.is_alphabetic() || c == '_') {
                        path.push(words[at + 1].clone());
                        at += 2;
                    }
                    file.paths.extend(from_crate(&path, (root, &here), &file, known));
                }
                _ => {}
            }
        }
    }
    file
}

/// Split code into words and signs; `::` is one sign.
fn words(code: &str) -> Vec<String> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut words: Vec<String> = Vec::new();
    let mut rest = code.trim_start();
    while let Some(c) = rest.chars().next() {
        let end = match c {
            _ if is_word(c) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
            _ if rest.starts_with("::") => 2,
            _ => c.len_utf8(),
        };
        words.push(rest[..end].into());
        rest = rest[end..].trim_start();
    }
    words
}

/// Append the leaves of an import tree: each path and its local name. `at` moves past the tree.
fn tree(words: &[String], at: &mut usize, before: &[String], leaves: &mut Vec<(Names, String)>) {
    let mut path = before.to_vec();
    loop {
        match words[*at].as_str() {
            "{" => {
                *at += 1;
                while words[*at] != "}" {
                    tree(words, at, &path, leaves);
                    *at += usize::from(words[*at] == ",");
                }
                *at += 1;
                return;
            }
            "self" if !path.is_empty() => {}
            word => path.push(word.into()),
        }
        *at += 1;
        match words[*at].as_str() {
            "::" => *at += 1,
            "as" => {
                leaves.push((path, words[*at + 1].clone()));
                *at += 2;
                return;
            }
            _ => {
                let name = path.last().unwrap().clone();
                if name == "*" {
                    path.pop();
                }
                leaves.push((path, name));
                return;
            }
        }
    }
}

/// Return a path relative to the crate; `None` if it leads to another crate or starts with an item of the file.
fn from_crate(path: &[String], (root, here): (&Names, &Names), file: &File, known: &BTreeSet<Names>) -> Option<Names> {
    let child = [&**here, &path[..1]].concat();
    let ups = path.iter().take_while(|name| *name == "super").count();
    match path[0].as_str() {
        "crate" => Some([root, &path[1..]].concat()),
        "self" => Some([here, &path[1..]].concat()),
        "super" => Some([&here[..here.len() - ups], &path[ups..]].concat()),
        _ if known.contains(&child) => Some([here, path].concat()),
        name => match name.strip_prefix("raywright") {
            Some("" | "_base") => Some(path[1..].to_vec()),
            Some(room) => Some([&[room[1..].to_string()], &path[1..]].concat()),
            None => file.imports.get(name).map(|import| [import, &path[1..]].concat()),
        },
    }
}
