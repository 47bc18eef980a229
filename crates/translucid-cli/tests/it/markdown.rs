//! What the tests of the documentation read of Markdown: blocks of code, headings and links.

use std::path::{Path, PathBuf};

/// A page, read from its file.
pub(crate) struct Page {
    pub(crate) path: PathBuf,
    lines: Vec<String>,
}

/// A fenced block of code.
pub(crate) struct Code {
    pub(crate) language: String,
    /// Line of the opening fence, from 1.
    pub(crate) line: usize,
    pub(crate) lines: Vec<String>,
}

/// A link or an image.
pub(crate) struct Link {
    /// From 1.
    pub(crate) line: usize,
    pub(crate) target: String,
}

/// The root of the repository.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// All pages of a directory and those below it, in the order of their paths.
pub(crate) fn pages_below(directory: &Path) -> Vec<Page> {
    let entries = std::fs::read_dir(directory).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let mut pages = Vec::new();
    for path in paths {
        if path.is_dir() {
            pages.extend(pages_below(&path));
        } else if path.extension().is_some_and(|extension| extension == "md") {
            pages.push(Page::read(&path));
        }
    }
    pages
}

impl Page {
    pub(crate) fn read(path: &Path) -> Self {
        let text =
            std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        Self { path: path.to_owned(), lines: text.lines().map(str::to_owned).collect() }
    }

    /// The name of the file without its extension.
    pub(crate) fn stem(&self) -> &str {
        self.path.file_stem().unwrap().to_str().unwrap()
    }

    /// The fenced blocks of code.
    pub(crate) fn code(&self) -> Vec<Code> {
        let mut blocks: Vec<Code> = Vec::new();
        let mut is_open = false;
        for (i, line) in self.lines.iter().enumerate() {
            match (line.trim_start().strip_prefix("```"), is_open) {
                (Some(language), false) => {
                    blocks.push(Code {
                        language: language.trim().to_owned(),
                        line: i + 1,
                        lines: Vec::new(),
                    });
                    is_open = true;
                }
                (Some(_), true) => is_open = false,
                (None, true) => blocks.last_mut().unwrap().lines.push(line.clone()),
                (None, false) => {}
            }
        }
        assert!(!is_open, "{}: a block of code has no end", self.path.display());
        blocks
    }

    /// Lines that are not code, and their numbers from 1.
    fn prose(&self) -> impl Iterator<Item = (usize, &str)> {
        let mut is_code = false;
        self.lines.iter().enumerate().filter_map(move |(i, line)| {
            let is_fence = line.trim_start().starts_with("```");
            is_code ^= is_fence;
            (!is_code && !is_fence).then_some((i + 1, line.as_str()))
        })
    }

    /// Links and images, `[words](target)`, outside of code.
    pub(crate) fn links(&self) -> Vec<Link> {
        let mut links = Vec::new();
        for (line, text) in self.prose() {
            let text = without_code_spans(text);
            for (end, _) in text.match_indices("](") {
                let target = text[end + 2..].split([')', ' ']).next().unwrap_or_default();
                links.push(Link { line, target: target.to_owned() });
            }
        }
        links
    }

    /// Texts between backticks outside of blocks, and their lines.
    pub(crate) fn code_spans(&self) -> Vec<(usize, String)> {
        let spans = |(line, text): (usize, &str)| {
            let parts: Vec<String> = text.split('`').skip(1).step_by(2).map(str::to_owned).collect();
            parts.into_iter().map(move |span| (line, span))
        };
        self.prose().flat_map(spans).collect()
    }

    /// What a link after `#` may name: the headings as GitHub names them.
    pub(crate) fn anchors(&self) -> Vec<String> {
        let mut anchors: Vec<String> = Vec::new();
        for (_, line) in self.prose() {
            let Some(heading) =
                line.trim_start_matches('#').strip_prefix(' ').filter(|_| line.starts_with('#'))
            else {
                continue;
            };
            let slug = slug(heading.trim());
            let before = anchors.iter().filter(|anchor| is_numbered(anchor, &slug)).count();
            anchors.push(if before == 0 { slug } else { format!("{slug}-{before}") });
        }
        anchors
    }
}

/// A heading's name: small letters, digits, `-` and `_`, with `-` for spaces.
fn slug(heading: &str) -> String {
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
    kept.flat_map(char::to_lowercase).map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// Whether an anchor is that of the slug, or of a heading with the same one further down.
fn is_numbered(anchor: &str, slug: &str) -> bool {
    anchor.strip_prefix(slug).is_some_and(|rest| {
        rest.is_empty() || rest.strip_prefix('-').is_some_and(|number| number.parse::<u32>().is_ok())
    })
}

/// The line with what stands between backticks blanked.
fn without_code_spans(line: &str) -> String {
    let parts = line.split('`').enumerate();
    parts.map(|(i, part)| if i % 2 == 1 { " ".repeat(part.len()) } else { part.to_owned() }).collect()
}
