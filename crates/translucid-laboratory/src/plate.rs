//! Pictures on a page.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::markup::{escape, link};

/// A picture on a page, inside the page's text.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    /// Name of its file beside the page, with its ending.
    pub file: String,
    /// What it shows, for those who cannot see it.
    pub alternative: String,
    /// What stands below it.
    pub caption: String,
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// The picture as a PNG.
    pub png: Vec<u8>,
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
