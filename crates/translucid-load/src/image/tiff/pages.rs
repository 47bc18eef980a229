//! The pages of a TIFF that are its picture.

use super::super::tags::Directory;
use super::tag;

/// The pages of a picture: one, or one each of red, green and blue.
pub(super) struct Pages<'a> {
    pub(super) pages: Vec<Directory<'a>>,
    /// A warning where others may be meant, too.
    pub(super) doubt: Option<String>,
}

/// What ImageJ writes into the description.
#[derive(Debug, Default, PartialEq)]
struct ImageJ {
    is_image_j: bool,
    images: usize,
    channels: usize,
    is_in_color: bool,
}

impl ImageJ {
    fn parse(description: &str) -> Self {
        let mut lines = description.lines();
        if !lines.next().is_some_and(|line| line.starts_with("ImageJ=")) {
            return Self::default();
        }
        let mut found = Self { is_image_j: true, images: 1, channels: 1, is_in_color: false };
        for (name, value) in lines.filter_map(|line| line.split_once('=')) {
            let number = || value.trim().parse().unwrap_or(1);
            match name.trim() {
                "images" => found.images = number(),
                "channels" => found.channels = number(),
                "mode" => found.is_in_color = matches!(value.trim(), "color" | "composite"),
                _ => {}
            }
        }
        found
    }
}

impl<'a> Pages<'a> {
    /// Chooses among the pages, thumbnails and masks left out.
    ///
    /// # Errors
    /// There are several gray pages and it is not known what they are: a message, and what to do.
    pub(super) fn choose(directories: &[Directory<'a>]) -> Result<Self, (String, &'static str)> {
        const HELP: &str = "save the picture alone, and one of red, green and blue as RGB in one page (in ImageJ: \
                            Image > Type > RGB Color for 8 bits, else a channel a page in a hyperstack of 3 channels)";
        let is_full = |page: &&Directory<'a>| page.number(tag::NEW_SUBFILE_TYPE).unwrap_or_default() & 5 == 0;
        let mut full: Vec<_> = directories.iter().filter(is_full).cloned().collect();
        if full.is_empty() {
            full = directories[..1].to_vec();
        }
        let first = &full[0];
        let about = ImageJ::parse(&first.text(tag::DESCRIPTION));
        let size = |page: &Directory<'_>| [tag::WIDTH, tag::HEIGHT, tag::BITS].map(|tag| page.number(tag));
        let is_gray = |page: &Directory<'_>| {
            matches!(page.number(tag::PHOTOMETRIC), Some(0 | 1) | None)
                && page.number(tag::SAMPLES).unwrap_or(1) == 1
        };
        let is_stack = full.iter().all(|page| is_gray(page) && size(page) == size(first));
        let count = full.len();
        if about.is_image_j && about.images > count {
            let message = format!("is a stack of {} images by ImageJ in one page of TIFF", about.images);
            return Err((message, HELP));
        }
        if count == 3 && is_stack && about.channels == 3 {
            let doubt = (!about.is_in_color)
                .then(|| "its three channels by ImageJ are taken as red, green and blue".to_owned());
            return Ok(Self { pages: full, doubt });
        }
        if count > 1 && is_stack {
            return Err((
                format!("has {count} gray pages of one size: which is the picture is not known"),
                HELP,
            ));
        }
        let doubt =
            (count > 1).then(|| format!("the first of its {count} pages is read, the others are left out"));
        full.truncate(1);
        Ok(Self { pages: full, doubt })
    }
}
