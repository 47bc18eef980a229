//! Names of image formats that are not read, and what to make of their files.

use translucid_scene::SceneError;

use super::file_bytes::ImageBytes;
use super::tags::Directory;

/// Formats by the bytes that they have at a place.
const FORMATS: [(usize, &[u8], &str); 29] = [
    (0, b"GIF8", "a GIF"),
    (0, b"BM", "a BMP"),
    (0, b"8BPS", "a Photoshop document"),
    (0, b"\0\0\0\x0cJXL ", "a JPEG XL"),
    (0, b"\xff\x0a", "a JPEG XL"),
    (0, b"\0\0\0\x0cjP  ", "a JPEG 2000"),
    (0, b"\xff\x4f\xff\x51", "a JPEG 2000"),
    (0, b"\xabKTX", "a KTX texture"),
    (0, b"sB", "a Basis texture"),
    (0, b"DDS ", "a DDS texture"),
    (0, b"P3", "a PPM"),
    (0, b"P5", "a PGM"),
    (0, b"P6", "a PPM"),
    (0, b"PF\n", "a PFM"),
    (0, b"Pf\n", "a PFM"),
    (0, b"SDPX", "a DPX"),
    (0, b"XPDS", "a DPX"),
    (0, b"\x80\x2a\x5f\xd7", "a Cineon"),
    (0, b"SIMPLE", "a FITS"),
    (0, b"%PDF", "a PDF"),
    (0, b"<svg", "an SVG"),
    (0, b"\x93NUMPY", "an array of NumPy"),
    (0, b"gimp xcf", "a GIMP document"),
    (0, b"\x01\xda", "an SGI image"),
    (0, b"qoif", "a QOI"),
    (0, b"farbfeld", "a farbfeld"),
    (0, b"II\xbc\x01", "a JPEG XR"),
    (0, b"PK\x03\x04", "a ZIP archive"),
    (0, b"\0\0\x01\0", "an icon"),
];

/// Formats of cameras by the bytes that they have at a place.
const RAW_FORMATS: [(usize, &[u8], &str); 9] = [
    (0, b"FUJIFILMCCD-RAW", "RAF"),
    (0, b"IIU\0", "RW2"),
    (0, b"IIRO", "ORF"),
    (0, b"IIRS", "ORF"),
    (0, b"MMOR", "ORF"),
    (0, b"FOVb", "X3F"),
    (0, b"\0MRM", "MRW"),
    (4, b"ftypcrx ", "CR3"),
    (6, b"HEAPCCDR", "CRW"),
];

/// What a file is that no decoder takes, and what to save it as.
pub(super) fn refusal(source: &ImageBytes<'_>) -> SceneError {
    let bytes = source.bytes;
    let has = |(at, magic): (usize, &[u8])| bytes.get(at..).is_some_and(|rest| rest.starts_with(magic));
    if bytes.is_empty() {
        return source.error("is empty, but an image is expected").with_help(READ);
    }
    if let Some((.., name)) = RAW_FORMATS.iter().find(|(at, magic, _)| has((*at, magic))) {
        return raw(source, name);
    }
    let named = FORMATS.iter().find(|(at, magic, _)| has((*at, magic))).map(|(.., name)| *name);
    let is_targa = bytes.ends_with(b"TRUEVISION-XFILE.\0") || has_targa_name(source);
    match named.or_else(|| container(bytes)).or(is_targa.then_some("a TGA")) {
        Some(name) => source.error(format!("is {name}, which cannot be read")).with_help(SAVE_AS),
        None => source.error("is not an image of a known format").with_help(READ),
    }
}

const READ: &str = "PNG, JPEG, WebP, TIFF, OpenEXR and Radiance HDR can be read";

const SAVE_AS: &str = "save it as PNG of 16 bits, TIFF or OpenEXR with its color profile, for instance by \
                       `oiiotool FILE -o FILE.png` or an image editor";

/// The pictures that are kept in containers of MPEG-4.
fn container(bytes: &[u8]) -> Option<&'static str> {
    if bytes.get(4..8) != Some(b"ftyp") {
        return None;
    }
    Some(match bytes.get(8..12) {
        Some(b"avif" | b"avis") => "an AVIF",
        Some(b"heic" | b"heix" | b"hevc" | b"heim" | b"heis" | b"mif1" | b"msf1") => "a HEIC",
        _ => "a video or picture in a container of MPEG-4",
    })
}

/// Whether the file is called so: TGA has no bytes of its own at its beginning.
fn has_targa_name(source: &ImageBytes<'_>) -> bool {
    source.place.to_string().to_ascii_lowercase().ends_with(".tga")
}

/// The name of a camera's format that is built as TIFF is, if the directories are of one.
pub(super) fn raw_in_tiff(bytes: &[u8], pages: &[Directory<'_>]) -> Option<&'static str> {
    let first = pages.first()?;
    if first.has(50706) {
        return Some("DNG");
    }
    if bytes.get(8..10) == Some(b"CR") {
        return Some("CR2");
    }
    // Color filter array, and the linear colors of a raw converter (TIFF/EP, DNG)
    let is_raw = |directory: &Directory<'_>| matches!(directory.number(262), Some(32803 | 34892));
    let children = pages.iter().flat_map(|page| page.children(330));
    if !pages.iter().any(is_raw) && !children.into_iter().any(|child| is_raw(&child)) {
        return None;
    }
    let maker = first.text(271).to_ascii_uppercase();
    let names =
        [("NIKON", "NEF"), ("SONY", "ARW"), ("PENTAX", "PEF"), ("SAMSUNG", "SRW"), ("HASSELBLAD", "3FR")];
    let known = names.iter().find(|(name, _)| maker.starts_with(name));
    Some(known.map_or("raw", |(_, format)| format))
}

/// The refusal of a camera's raw file, with the commands that develop it to numbers proportional to light.
pub(super) fn raw(source: &ImageBytes<'_>, format: &str) -> SceneError {
    let file = source.place.to_string();
    let message = format!("is a camera's raw file ({format}), which cannot be read");
    source.error(message).with_help(format!(
        "develop it to linear numbers without white balance, by `dcraw -4 -T -o 0 -r 1 1 1 1 {file}`, or by `pip \
         install rawpy tifffile` and `python -c \"import rawpy, tifffile; tifffile.imwrite('photo.tif', \
         rawpy.imread('{file}').postprocess(gamma=(1, 1), no_auto_bright=True, output_bps=16, \
         output_color=rawpy.ColorSpace.raw, user_wb=[1, 1, 1, 1]))\"`; then measure the TIFF with --linear"
    ))
}
