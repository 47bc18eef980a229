//! The documentation keeps its word: commands print what the pages show, scenes load, links lead somewhere.

use std::path::{Path, PathBuf};

use crate::common::{run, stderr};
use crate::markdown::{Code, Page, pages_below, root};
use translucid_profile::Model;
use translucid_scene::SubsurfaceModel;

/// The pages of `docs/models` but the one that compares them.
fn model_pages() -> Vec<Page> {
    let mut pages = pages_below(&root().join("docs/models"));
    pages.retain(|page| page.stem() != "which-one");
    pages
}

fn of_language<'a>(code: &'a [Code], language: &str) -> Vec<&'a Code> {
    code.iter().filter(|block| block.language == language).collect()
}

/// Two texts, word by word: numbers may differ by rounding, which is not the same on all processors.
fn is_same_but_for_rounding(found: &str, shown: &str) -> bool {
    let words = |text: &str| -> Vec<String> {
        text.split([',', ' ']).filter(|word| !word.is_empty()).map(str::to_owned).collect()
    };
    let (found, shown) = (words(found), words(shown));
    let is_same = |(found, shown): (&String, &String)| match (found.parse::<f64>(), shown.parse::<f64>()) {
        (Ok(found), Ok(shown)) => (found - shown).abs() <= 1e-9 * shown.abs() + 1e-15,
        _ => found == shown,
    };
    found.len() == shown.len() && found.iter().zip(&shown).all(is_same)
}

/// Every line `$ translucid …` of a block `console` is run, and what follows it is what the command printed.
#[test]
fn commands_print_what_the_pages_show() {
    let mut pages = model_pages();
    let accuracy = pages_below(&root().join("docs/accuracy"));
    pages.extend(accuracy.into_iter().filter(|page| page.stem() == "color-spaces"));
    for page in pages {
        let code = page.code();
        let blocks = of_language(&code, "console");
        assert!(!blocks.is_empty(), "{}: no command", page.path.display());
        let directory = tempfile::tempdir().unwrap();
        for block in blocks {
            let place = format!("{}:{}", page.path.display(), block.line);
            let mut lines = block.lines.iter().peekable();
            while let Some(line) = lines.next() {
                let words = line.strip_prefix("$ translucid ").unwrap_or_else(|| panic!("{place}: {line}"));
                let output = run(directory.path(), words);
                assert!(output.status.success(), "{place}: {line}: {}", stderr(&output));
                for found in String::from_utf8(output.stdout).unwrap().lines() {
                    let shown = lines.next().map_or("", String::as_str);
                    assert!(
                        is_same_but_for_rounding(found, shown),
                        "{place}: {line}\nthe command prints  {found}\nthe page shows      {shown}"
                    );
                }
                assert!(
                    lines.peek().is_none_or(|next| next.starts_with("$ ")),
                    "{place}: more than {line} prints"
                );
            }
        }
    }
}

/// Every block `toml` is a material, with which a scene of a sphere renders.
#[test]
fn materials_of_the_pages_render() {
    for page in model_pages() {
        let code = page.code();
        let blocks = of_language(&code, "toml");
        assert!(!blocks.is_empty(), "{}: no material", page.path.display());
        for block in blocks {
            let place = format!("{}:{}", page.path.display(), block.line);
            let directory = tempfile::tempdir().unwrap();
            let name = block.lines.iter().find_map(|line| line.strip_prefix("name = ")).expect("a name");
            let object = format!("[[object]]\nshape = \"sphere\"\nradius = 5\nmaterial = {name}\n");
            let scene = format!("unit = \"mm\"\n{}\n{object}", block.lines.join("\n"));
            std::fs::write(directory.path().join("scene.toml"), scene).unwrap();
            let samples = "r,reflectance\n0.1,0.6\n0.3,0.14\n1,0.025\n3,0.0022\n10,0.00002\n";
            std::fs::write(directory.path().join("mine.csv"), samples).unwrap();
            let output = run(directory.path(), "render scene.toml --size 8x8 --spp 1 -o scene.png");
            assert!(output.status.success(), "{place}: {}", stderr(&output));
        }
    }
}

/// Every command that renders names a model that there is, and the page's own one.
#[test]
fn commands_that_render_name_the_model_of_their_page() {
    for page in model_pages() {
        for block in of_language(&page.code(), "sh") {
            for line in &block.lines {
                let place = format!("{}:{}: {line}", page.path.display(), block.line);
                let mut words = line.split_whitespace().skip_while(|word| *word != "--subsurface").skip(1);
                let model = words.next().unwrap_or_else(|| panic!("{place}"));
                assert!(SubsurfaceModel::from_name(model).is_some(), "{place}");
                assert_eq!(model, page.stem(), "{place}");
            }
        }
    }
}

/// Every model is in the index, and in no page is a block of code of which nobody says what it is: without a language
/// rustdoc takes it for Rust.
#[test]
fn index_has_every_model_and_code_its_language() {
    let index = std::fs::read_to_string(root().join("docs/models/which-one.md")).unwrap();
    for model in Model::ALL.map(Model::name).into_iter().chain(["random-walk"]) {
        assert!(index.contains(&format!("[`{model}`](")), "docs/models/which-one.md does not link {model}");
    }
    for page in model_pages() {
        for block in page.code() {
            let known = ["text", "sh", "console", "toml", "rust", "python"];
            let place = format!("{}:{}", page.path.display(), block.line);
            assert!(known.contains(&block.language.as_str()), "{place}: {:?}", block.language);
        }
    }
}

/// Where a link leads, if it is broken: links are relative to the page, an anchor is a heading.
fn broken(page: &Page, target: &str) -> Option<String> {
    if target.contains("://") || target.starts_with("mailto:") {
        return None;
    }
    let (file, anchor) = target.split_once('#').map_or((target, None), |(file, anchor)| (file, Some(anchor)));
    let path: PathBuf = if file.is_empty() {
        page.path.clone()
    } else {
        page.path.parent().unwrap_or(Path::new("")).join(file)
    };
    if !path.exists() {
        return Some("there is no such file".to_owned());
    }
    let anchor = anchor?;
    let anchors = Page::read(&path).anchors();
    (!anchors.iter().any(|found| found == anchor)).then(|| format!("its headings are {}", anchors.join(", ")))
}

/// Every page is in the table of contents, once, and nothing else is.
#[test]
fn contents_list_every_page() {
    let docs = root().join("docs");
    let contents = Page::read(&docs.join("SUMMARY.md"));
    let mut listed: Vec<PathBuf> = contents.links().iter().map(|link| docs.join(&link.target)).collect();
    listed.sort();
    let mut pages: Vec<PathBuf> = pages_below(&docs).into_iter().map(|page| page.path).collect();
    pages.retain(|path| *path != contents.path);
    pages.sort();
    assert_eq!(listed, pages);
}

/// Every whole scene of the guide renders.
#[test]
fn scenes_of_the_guide_render() {
    let mut count = 0;
    for name in ["first-picture", "materials"] {
        let page = Page::read(&root().join(format!("docs/guide/{name}.md")));
        let code = page.code();
        for block in of_language(&code, "toml") {
            let directory = tempfile::tempdir().unwrap();
            for document in of_language(&code, "xml") {
                std::fs::write(directory.path().join("soap.mtlx"), document.lines.join("\n")).unwrap();
            }
            std::fs::write(directory.path().join("scene.toml"), block.lines.join("\n")).unwrap();
            let output = run(directory.path(), "render scene.toml --size 8x8 --spp 1 -o scene.png");
            assert!(output.status.success(), "{}:{}: {}", page.path.display(), block.line, stderr(&output));
            count += 1;
        }
    }
    assert_eq!(count, 4);
}

/// Every command of the guide that takes a moment runs; those that render or walk are options of others' tests.
#[test]
fn commands_of_the_guide_run() {
    let verbs = ["profile", "sample", "convert", "reference --method exact", "render --preset list"];
    let directory = tempfile::tempdir().unwrap();
    let samples = "r,reflectance\n0.1,0.6\n0.3,0.14\n1,0.025\n3,0.0022\n10,0.00002\n";
    std::fs::write(directory.path().join("mine.csv"), samples).unwrap();
    let mut count = 0;
    for page in pages_below(&root().join("docs/guide")) {
        let code = page.code();
        for line in of_language(&code, "sh").iter().flat_map(|block| &block.lines) {
            let Some(words) = line.strip_prefix("translucid ") else { continue };
            if verbs.iter().any(|verb| words.starts_with(verb)) {
                let output = run(directory.path(), words);
                assert!(output.status.success(), "{}: {line}: {}", page.path.display(), stderr(&output));
                count += 1;
            }
        }
    }
    assert!(count >= 8, "{count}");
}

#[test]
fn links_lead_somewhere() {
    let mut pages = pages_below(&root().join("docs"));
    pages.extend(
        ["README.md", "ARCHITECTURE.md", "CHANGELOG.md", "benches/peers/README.md"]
            .map(|name| Page::read(&root().join(name))),
    );
    let mut wrong = Vec::new();
    let mut count = 0;
    for page in &pages {
        for link in page.links() {
            count += 1;
            if let Some(why) = broken(page, &link.target) {
                wrong.push(format!("{}:{}: {}: {why}", page.path.display(), link.line, link.target));
            }
        }
    }
    assert!(wrong.is_empty(), "broken links:\n{}", wrong.join("\n"));
    assert!(count > 30, "{count} links");
}

/// A book is read without the repository around it: its pages link to each other and to their pictures.
#[test]
fn links_of_the_book_stay_in_it() {
    let docs = root().join("docs").canonicalize().unwrap();
    let leaves = |page: &Page, target: &str| {
        let file = target.split('#').next().unwrap_or_default();
        let path = page.path.parent().unwrap_or(Path::new("")).join(file);
        !target.contains("://") && path.canonicalize().is_ok_and(|path| !path.starts_with(&docs))
    };
    let mut outside = Vec::new();
    for page in pages_below(&docs) {
        let links = page.links().into_iter().filter(|link| leaves(&page, &link.target));
        outside.extend(links.map(|link| format!("{}:{}: {}", page.path.display(), link.line, link.target)));
    }
    assert!(outside.is_empty(), "links out of docs/; name the file in words:\n{}", outside.join("\n"));
    assert!(leaves(&Page::read(&docs.join("README.md")), "../Cargo.toml"));
}

/// Every file of the project that a page names, as `crates/…`, is there.
#[test]
fn files_that_pages_name_are_there() {
    let mut pages = pages_below(&root().join("docs"));
    pages.extend(["README.md", "ARCHITECTURE.md"].map(|name| Page::read(&root().join(name))));
    let mut wrong = Vec::new();
    for page in &pages {
        for (line, span) in page.code_spans() {
            let is_path = ["crates/", "benches/", "scenes/", "python/", "examples/"]
                .iter()
                .any(|folder| span.starts_with(folder));
            if is_path && !span.contains([' ', '*']) && !root().join(&span).exists() {
                wrong.push(format!("{}:{line}: {span}", page.path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "there are no such files:\n{}", wrong.join("\n"));
}

#[test]
fn broken_links_are_found() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("page.md");
    let text = "# A `b` & c!\n\n## Twice\n\n## Twice\n\n[x](#a-b--c) [x](#twice-1) [x](page.md#twice) `[x](no.md)`\n\n\
                [x](no.md) [x](#twice-2) ![x](no.svg)\n\n```text\n[x](no.md)\n```\n";
    std::fs::write(&path, text).unwrap();
    let page = Page::read(&path);
    let wrong: Vec<(usize, String)> = page
        .links()
        .into_iter()
        .filter(|link| broken(&page, &link.target).is_some())
        .map(|link| (link.line, link.target))
        .collect();
    let expected = [(9, "no.md"), (9, "#twice-2"), (9, "no.svg")];
    assert_eq!(wrong, expected.map(|(line, target)| (line, target.to_owned())));
}
