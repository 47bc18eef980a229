//! The page's files, part of the program.

/// A file of the page: its path below the page's address, its media type, its bytes.
pub(crate) struct PageFile {
    pub(crate) path: &'static str,
    pub(crate) media_type: &'static str,
    pub(crate) bytes: &'static [u8],
}

macro_rules! page_files {
    ($($path:literal: $media_type:expr,)*) => {
        /// Every file of the page.
        pub(crate) const PAGE_FILES: &[PageFile] = &[$(PageFile {
            path: $path,
            media_type: $media_type,
            bytes: include_bytes!(concat!("../page/", $path)),
        }),*];
    };
}

const PAGE: &str = "text/html; charset=utf-8";
const STYLE: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const PICTURE: &str = "image/svg+xml";
const PHOTO: &str = "image/jpeg";
const TEXT: &str = "text/plain; charset=utf-8";

page_files! {
    "index.html": PAGE,
    "camera.js": SCRIPT,
    "color.js": SCRIPT,
    "compare.js": SCRIPT,
    "connection.js": SCRIPT,
    "copy.js": SCRIPT,
    "dock.js": SCRIPT,
    "dom.js": SCRIPT,
    "environment.js": SCRIPT,
    "events.js": SCRIPT,
    "field.js": SCRIPT,
    "gesture.js": SCRIPT,
    "history.js": SCRIPT,
    "host.js": SCRIPT,
    "icon.svg": PICTURE,
    "inspector.js": SCRIPT,
    "keyboard.js": SCRIPT,
    "lights.js": SCRIPT,
    "main.js": SCRIPT,
    "material.js": SCRIPT,
    "mean-free-path.js": SCRIPT,
    "menus.js": SCRIPT,
    "navigation.js": SCRIPT,
    "notices.js": SCRIPT,
    "numbers-panel.js": SCRIPT,
    "numbers.js": SCRIPT,
    "pacing.js": SCRIPT,
    "picture.js": SCRIPT,
    "placement.js": SCRIPT,
    "presets.jpg": PHOTO,
    "probe.js": SCRIPT,
    "profile-panel.js": SCRIPT,
    "render.js": SCRIPT,
    "row.js": SCRIPT,
    "scale-bar.js": SCRIPT,
    "scale.js": SCRIPT,
    "session.js": SCRIPT,
    "slider.js": SCRIPT,
    "status.js": SCRIPT,
    "storage.js": SCRIPT,
    "style.css": STYLE,
    "tabs.js": SCRIPT,
    "theme.js": SCRIPT,
    "units.js": SCRIPT,
    "vector.js": SCRIPT,
    "vendor/uplot/LICENSE": TEXT,
    "vendor/uplot/uPlot.esm.js": SCRIPT,
    "vendor/uplot/uPlot.min.css": STYLE,
    "view-bar.js": SCRIPT,
    "watch.js": SCRIPT,
    "words.js": SCRIPT,
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;

    #[test]
    fn page_has_every_file_of_its_folder() {
        fn visit(folder: &Path, below: &str, found: &mut Vec<String>) {
            for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
                let name = format!("{below}{}", entry.file_name().to_str().unwrap());
                if entry.path().is_dir() {
                    visit(&entry.path(), &format!("{name}/"), found);
                } else {
                    found.push(name);
                }
            }
        }
        let mut found = Vec::new();
        visit(&Path::new(env!("CARGO_MANIFEST_DIR")).join("page"), "", &mut found);
        let mut listed: Vec<&str> = PAGE_FILES.iter().map(|file| file.path).collect();
        found.sort_unstable();
        listed.sort_unstable();
        assert_eq!(found, listed);
    }
}
