//! A page of text, charts, pictures and tables.

use std::collections::HashSet;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::chart::Chart;
use crate::chart::Shade;
use translucid_words::DataTable;

use crate::data_table::html;
use crate::markup::{escape, identifier, link};

/// A piece of a section.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// A paragraph, without markup.
    Text(String),
    /// A chart with its caption.
    Chart(Chart),
    /// A table with its caption.
    Table(DataTable),
    /// Pictures beside each other.
    Plates(Vec<Plate>),
}

/// A picture on a page, inside the page's text.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    /// Name of its file beside the page, with its ending.
    pub file: String,
    /// Content in words, for those who cannot see it.
    pub alternative: String,
    /// Words below it.
    pub caption: String,
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// The picture as a PNG.
    pub png: Vec<u8>,
}

/// A part of a page under one title.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Its title.
    pub title: String,
    /// Pieces from top to bottom.
    pub blocks: Vec<Block>,
}

/// A page of text, charts and tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// Its title.
    pub title: String,
    /// Paragraphs before the table of contents, without markup.
    pub introduction: Vec<String>,
    /// Its sections.
    pub sections: Vec<Section>,
}

impl Section {
    /// A section without blocks.
    pub fn new(title: &str) -> Self {
        Self { title: title.to_owned(), blocks: Vec::new() }
    }
}

impl Page {
    /// The charts, from top to bottom.
    pub fn charts(&self) -> impl Iterator<Item = &Chart> {
        self.blocks().filter_map(|block| if let Block::Chart(chart) = block { Some(chart) } else { None })
    }

    /// The tables, from top to bottom.
    pub fn tables(&self) -> impl Iterator<Item = &DataTable> {
        self.blocks().filter_map(|block| if let Block::Table(table) = block { Some(table) } else { None })
    }

    fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.sections.iter().flat_map(|section| &section.blocks)
    }

    /// The page as one HTML file that needs nothing else: no script, no font, no network.
    ///
    /// Charts are inside as SVG, pictures as PNG; charts and the text turn dark where the reader's system is, and light in print.
    /// Below each stand links to its files, NAME.svg and NAME.csv, and below a table to NAME.csv; they
    /// are expected beside the page.
    /// The text is XML, too.
    pub fn html(&self) -> String {
        let mut ids = HashSet::new();
        let anchors: Vec<String> =
            self.sections.iter().map(|section| unique(&mut ids, "section", &section.title)).collect();
        let mut contents = String::new();
        let mut body = String::new();
        let mut counts = Counts::default();
        for (section, anchor) in self.sections.iter().zip(&anchors) {
            let title = escape(&section.title);
            contents += &format!("<li><a href=\"#{anchor}\">{title}</a>");
            body += &format!("<section id=\"{anchor}\">\n<h2>{title}</h2>\n");
            let mut inner = String::new();
            for block in &section.blocks {
                let (id, entry, html) = part(block, &mut ids, &mut counts);
                body += &html;
                if !entry.is_empty() {
                    inner += &format!("<li><a href=\"#{id}\">{entry}</a></li>");
                }
            }
            if !inner.is_empty() {
                contents += &format!("<ul>{inner}</ul>");
            }
            contents += "</li>\n";
            body += "</section>\n";
        }
        let introduction: String = self.introduction.iter().map(|text| paragraph(text)).collect();
        let title = escape(&self.title);
        let style = style();
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n\
             <meta charset=\"utf-8\" />\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n\
             <meta name=\"generator\" content=\"translucid\" />\n\
             <meta name=\"color-scheme\" content=\"light dark\" />\n<title>{title}</title>\n<style>\n{style}</style>\n\
             </head>\n<body>\n<header>\n<h1>{title}</h1>\n{introduction}</header>\n\
             <nav aria-labelledby=\"contents\">\n<h2 id=\"contents\">Contents</h2>\n<ol>\n{contents}</ol>\n</nav>\n\
             <main>\n{body}</main>\n</body>\n</html>\n"
        )
    }
}

impl Plate {
    /// The picture with its caption and a link to its file.
    pub(crate) fn html(&self) -> String {
        let [width, height] = self.size;
        let [alternative, caption, file] =
            [&self.alternative, &self.caption, &self.file].map(|text| escape(text));
        format!(
            "<figure>\n<img src=\"data:image/png;base64,{}\" alt=\"{alternative}\" width=\"{width}\" \
             height=\"{height}\" />\n<figcaption>{caption} <span class=\"files\"><a href=\"{}\">{file}</a></span>\
             </figcaption>\n</figure>\n",
            STANDARD.encode(&self.png),
            link(&self.file),
        )
    }
}

/// Figures and tables so far.
#[derive(Default)]
struct Counts {
    figures: usize,
    tables: usize,
}

/// Id, entry in the contents and HTML of a block.
fn part(block: &Block, ids: &mut HashSet<String>, counts: &mut Counts) -> (String, String, String) {
    match block {
        Block::Text(text) => (String::new(), String::new(), paragraph(text)),
        Block::Plates(plates) => {
            let plates: String = plates.iter().map(Plate::html).collect();
            (String::new(), String::new(), format!("<div class=\"plates\">\n{plates}</div>\n"))
        }
        Block::Chart(chart) => {
            counts.figures += 1;
            let id = unique(ids, "figure", &chart.name);
            let number = counts.figures;
            let files = links(&chart.name, &chart.title, &["svg", "csv"]);
            let html = format!(
                "<figure id=\"{id}\">\n{}\n<figcaption><b>Figure {number}.</b> {} {files}</figcaption>\n</figure>\n",
                chart.svg(),
                escape(&chart.caption),
            );
            (id, format!("Figure {number}: {}", escape(&chart.title)), html)
        }
        Block::Table(table) => {
            counts.tables += 1;
            let id = unique(ids, "table", &table.name);
            let number = counts.tables;
            let files = links(&table.name, &table.caption, &["csv"]);
            // A region that scrolls must be in reach of the keyboard
            let html = format!(
                "<div id=\"{id}\" class=\"table\">\n<div class=\"scroll\" role=\"region\" tabindex=\"0\" \
                 aria-label=\"Table {number}\">\n{}</div>\n<p class=\"files\"><b>Table {number}.</b> {files}</p>\n</div>\n",
                html(table),
            );
            (id, format!("Table {number}: {}", escape(&table.caption)), html)
        }
    }
}

fn paragraph(text: &str) -> String {
    format!("<p>{}</p>\n", escape(text))
}

/// Links to the files of a chart or table.
fn links(name: &str, what: &str, endings: &[&str]) -> String {
    let what = escape(what);
    let each = |ending: &&str| {
        let kind = ending.to_uppercase();
        format!("<a href=\"{}.{ending}\" aria-label=\"{kind} of {what}\">{kind}</a>", link(name))
    };
    format!("<span class=\"files\">{}</span>", endings.iter().map(each).collect::<Vec<_>>().join(" "))
}

/// An id that no other element of the page has.
fn unique(ids: &mut HashSet<String>, kind: &str, name: &str) -> String {
    let stem = format!("{kind}-{}", identifier(name));
    let mut id = stem.clone();
    let mut count = 1;
    while !ids.insert(id.clone()) {
        count += 1;
        id = format!("{stem}-{count}");
    }
    id
}

/// The style sheet: one column that is easy to read; figures turn dark by the colors that they have.
fn style() -> String {
    let dark: String = Shade::ALL
        .iter()
        .map(|Shade { light, dark }| {
            format!(
                "svg[fill=\"{light}\"],svg [fill=\"{light}\"]{{fill:{dark}}}svg [stroke=\"{light}\"]{{stroke:{dark}}}\n"
            )
        })
        .collect();
    let [paper, dark_paper] = [Shade::BACKGROUND.light, Shade::BACKGROUND.dark];
    let [text, dark_text] = [Shade::TEXT.light, Shade::TEXT.dark];
    let [rule, dark_rule] = [Shade::GRID.light, Shade::GRID.dark];
    let [link, dark_link] = ["#0062a0", "#7cc0f0"];
    format!(
        ":root{{color-scheme:light dark;--paper:{paper};--text:{text};--rule:{rule};--link:{link}}}\n{STYLE}\
         @media screen and (prefers-color-scheme:dark){{\n\
         :root{{--paper:{dark_paper};--text:{dark_text};--rule:{dark_rule};--link:{dark_link}}}\n{dark}}}\n\
         @media print{{{PRINT}}}\n"
    )
}

/// The style of every medium.
const STYLE: &str = "\
*{box-sizing:border-box}
body{margin:0 auto;max-width:58rem;padding:1.5rem 1rem 4rem;background:var(--paper);color:var(--text);\
font:1rem/1.55 system-ui,-apple-system,\"Segoe UI\",Roboto,\"Helvetica Neue\",Arial,sans-serif}
h1{font-size:1.8rem;line-height:1.25;margin:0 0 1rem}
h2{font-size:1.35rem;line-height:1.3;margin:2.5rem 0 .75rem;padding-top:.75rem;border-top:1px solid var(--rule)}
p{max-width:46rem;margin:.6rem 0}
a{color:var(--link)}
a:focus-visible,.scroll:focus-visible{outline:2px solid var(--link);outline-offset:2px}
nav ol,nav ul{margin:.3rem 0;padding-left:1.5rem}
nav ul{font-size:.92rem;list-style:none;padding-left:1rem}
figure{margin:1.5rem 0 2rem}
figure svg{display:block;width:100%;max-width:52rem;height:auto}
figcaption{max-width:46rem;margin-top:.4rem;font-size:.94rem}
.files{font-size:.88rem;white-space:nowrap}
.plates{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(22rem,100%),1fr));gap:0 1rem}
.plates figure{margin:.75rem 0}
.plates img{display:block;width:100%;height:auto}
.table{margin:1.5rem 0 2rem}
.scroll{overflow-x:auto}
table{border-collapse:collapse;font-size:.92rem;font-variant-numeric:tabular-nums}
caption{text-align:left;font-weight:600;padding:.3rem 0}
th,td{padding:.28rem .8rem .28rem 0;text-align:left;border-bottom:1px solid var(--rule);vertical-align:top}
thead th{border-bottom:2px solid var(--text);vertical-align:bottom}
tbody th{font-weight:400}
.number{text-align:right;white-space:nowrap}
";

/// Style of paper, where it differs.
const PRINT: &str = "body{max-width:none;padding:0;font-size:10pt}nav,.files{display:none}\
figure,tr{break-inside:avoid}.scroll{overflow:visible}table{font-size:8pt}td,th{padding-right:.5rem}h2{break-after:avoid}figure svg{max-width:17cm}a{color:inherit;text-decoration:none}\
@page{margin:18mm}";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Ink, Mark, Series};

    fn page() -> Page {
        let chart = |name: &str| {
            Chart::new(name, "A <chart> & \"more\"", Axis::linear("r", "ℓ"), Axis::logarithmic("R", ""))
                .with_caption("What it <shows>.")
                .with(Series::new("a < b", Ink::Reference, Mark::Line, vec![[0.0, 1.0], [1.0, 2.0]]))
        };
        let mut table = DataTable::new("numbers", "Numbers > 0", &["word", "number"]);
        table.push(["a & b".into(), 1.0.into()]);
        let plate = Plate {
            file: String::from("a b.png"),
            alternative: String::from("a \"ball\""),
            caption: String::from("A <ball>."),
            size: [4, 2],
            png: b"\x89PNG".to_vec(),
        };
        let blocks = vec![
            Block::Text(String::from("x < y")),
            Block::Plates(vec![plate.clone(), plate]),
            Block::Chart(chart("one")),
            Block::Chart(chart("one")),
            Block::Table(table),
        ];
        let sections =
            vec![Section { title: String::from("Same & same"), blocks }, Section::new("Same & same")];
        Page {
            title: String::from("A page <of> figures"),
            introduction: vec![String::from("Why & how.")],
            sections,
        }
    }

    #[test]
    fn html_has_everything_once() {
        let html = page().html();
        let options = roxmltree::ParsingOptions { allow_dtd: true, ..roxmltree::ParsingOptions::default() };
        let document = roxmltree::Document::parse_with_options(&html, options).unwrap();
        let count = |name: &str| document.descendants().filter(|node| node.tag_name().name() == name).count();
        assert_eq!([count("figure"), count("svg"), count("table"), count("section")], [4, 2, 1, 2]);
        assert_eq!(count("script") + count("link"), 0);
        let images = document.descendants().filter(|node| node.has_tag_name("img"));
        let sources: Vec<&str> = images.filter_map(|image| image.attribute("src")).collect();
        assert_eq!(sources, ["data:image/png;base64,iVBORw=="; 2]);

        // Every id is there once, and every link within the page leads to one
        let ids: Vec<&str> = document.descendants().filter_map(|node| node.attribute("id")).collect();
        let distinct: HashSet<&str> = ids.iter().copied().collect();
        assert_eq!(ids.len(), distinct.len());
        let links: Vec<&str> = document.descendants().filter_map(|node| node.attribute("href")).collect();
        for link in &links {
            match link.strip_prefix('#') {
                Some(id) => assert!(distinct.contains(id), "{link} leads nowhere"),
                None => {
                    assert!(
                        link.starts_with("one.") || ["numbers.csv", "a%20b.png"].contains(link),
                        "{link}"
                    );
                }
            }
        }
        assert_eq!(links.iter().filter(|link| !link.starts_with('#')).count(), 7);
    }

    #[test]
    fn html_asks_nothing_of_a_network() {
        let html = page()
            .html()
            .replace("http://www.w3.org/2000/svg", "")
            .replace("http://www.w3.org/1999/xhtml", "");
        assert!(!html.contains("http") && !html.contains("//") && !html.contains("url("));
    }

    #[test]
    fn html_is_the_same_every_time() {
        assert_eq!(page().html(), page().html());
    }
}
