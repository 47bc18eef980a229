//! `--tev`: what a tev gets, by a server that takes nothing but its documented packets.

use std::collections::BTreeMap;
use std::io::{self, Read};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::thread::{self, JoinHandle};

use crate::common::{directory_with_ball, exr_values, files, run, stderr};

/// A picture that a tev shows.
#[derive(Default)]
struct Shown {
    width: i32,
    height: i32,
    /// Four channels a pixel, row by row.
    values: Vec<f32>,
    /// How often the pixel at the top left has been set.
    updates_of_corner: usize,
}

/// Pictures by name, and the names in the order in which they came and went.
#[derive(Default)]
struct Pictures {
    shown: BTreeMap<String, Shown>,
    order: Vec<String>,
}

impl Pictures {
    fn take(&mut self, packet: &[u8]) {
        let mut fields = Fields(packet);
        match fields.byte() {
            2 => {
                let name = fields.text();
                self.shown.remove(&name);
                self.order.push(format!("-{name}"));
            }
            4 => {
                assert!(fields.byte() <= 1);
                let name = fields.text();
                let (width, height) = (fields.int(), fields.int());
                assert!(width > 0 && height > 0);
                fields.channels();
                let values = vec![0.0; 4 * (width * height) as usize];
                let shown = Shown { width, height, values, updates_of_corner: 0 };
                assert!(self.shown.insert(name.clone(), shown).is_none(), "{name} is there already");
                self.order.push(format!("+{name}"));
            }
            6 => {
                assert_eq!(fields.byte(), 0, "an update leaves the focus alone");
                let name = fields.text();
                let picture = self.shown.get_mut(&name).expect("a picture that was made");
                fields.channels();
                picture.update(&mut fields);
            }
            kind => panic!("a packet of kind {kind}"),
        }
        assert!(fields.0.is_empty(), "{} bytes too many", fields.0.len());
    }
}

impl Shown {
    fn update(&mut self, fields: &mut Fields<'_>) {
        let [x, y, width, height] = [(); 4].map(|()| fields.int());
        assert!(x >= 0 && y >= 0 && width > 0 && height > 0);
        assert!(x + width <= self.width && y + height <= self.height);
        let offsets = [(); 4].map(|()| fields.long() as usize);
        let strides = [(); 4].map(|()| fields.long() as usize);
        let pixels = (width * height) as usize;
        let ends = offsets.iter().zip(strides).map(|(offset, stride)| offset + (pixels - 1) * stride + 1);
        let data = fields.floats(ends.max().unwrap());
        for pixel in 0..pixels {
            let (column, row) = (x as usize + pixel % width as usize, y as usize + pixel / width as usize);
            for channel in 0..4 {
                self.values[4 * (row * self.width as usize + column) + channel] =
                    data[offsets[channel] + pixel * strides[channel]];
            }
        }
        self.updates_of_corner += usize::from(x == 0 && y == 0);
    }

    fn bits(&self, channel: usize) -> Vec<u32> {
        self.values.iter().skip(channel).step_by(4).map(|value| value.to_bits()).collect()
    }

    /// Checks that a rectangle of the picture is an OpenEXR file, and the rest black.
    fn assert_is(&self, path: &Path, [left, top, width, height]: [usize; 4]) {
        let file: BTreeMap<_, _> = exr_values(path).into_iter().collect();
        for (channel, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
            let mut expected = vec![0; (self.width * self.height) as usize];
            for row in 0..height {
                let start = (top + row) * self.width as usize + left;
                expected[start..start + width].copy_from_slice(&file[name][row * width..(row + 1) * width]);
            }
            assert!(self.bits(channel) == expected, "channel {name} of {}", path.display());
        }
    }
}

/// What is left of a packet.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let (bytes, rest) = self.0.split_at(N);
        self.0 = rest;
        bytes.try_into().unwrap()
    }

    fn byte(&mut self) -> u8 {
        self.bytes::<1>()[0]
    }

    fn int(&mut self) -> i32 {
        i32::from_le_bytes(self.bytes())
    }

    fn long(&mut self) -> i64 {
        i64::from_le_bytes(self.bytes())
    }

    fn text(&mut self) -> String {
        let end = self.0.iter().position(|&byte| byte == 0).expect("a zero byte");
        let text = String::from_utf8(self.0[..end].to_vec()).unwrap();
        self.0 = &self.0[end + 1..];
        text
    }

    fn channels(&mut self) {
        assert_eq!(self.int(), 4);
        assert_eq!([(); 4].map(|()| self.text()), ["R", "G", "B", "A"]);
    }

    fn floats(&mut self, count: usize) -> Vec<f32> {
        (0..count).map(|_| f32::from_le_bytes(self.bytes())).collect()
    }
}

/// A packet without its length; none where the connection has ended between two.
fn packet(stream: &mut TcpStream) -> Option<Vec<u8>> {
    let mut length = [0; 4];
    match stream.read_exact(&mut length) {
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return None,
        result => result.unwrap(),
    }
    let mut bytes = vec![0; u32::from_le_bytes(length) as usize - 4];
    stream.read_exact(&mut bytes).unwrap();
    Some(bytes)
}

/// A port, and what `serve` makes of the connection to it.
fn server<T: Send + 'static>(serve: impl FnOnce(TcpStream) -> T + Send + 'static) -> (u16, JoinHandle<T>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    (port, thread::spawn(move || serve(listener.accept().unwrap().0)))
}

/// A tev that takes what comes until the connection ends.
fn tev() -> (u16, JoinHandle<Pictures>) {
    server(|mut stream| {
        let mut pictures = Pictures::default();
        while let Some(packet) = packet(&mut stream) {
            pictures.take(&packet);
        }
        pictures
    })
}

#[test]
fn tev_shows_the_picture_of_the_file() {
    let (_keep, directory) = directory_with_ball();
    let (port, tev) = tev();
    // More than one block both ways
    let words = format!("render ball.toml --tev=127.0.0.1:{port} --size 150x140 --spp 3 -o a.exr -q");
    let output = run(&directory, &words);
    assert_eq!((output.status.code(), stderr(&output)), (Some(0), String::new()));
    let pictures = tev.join().unwrap();
    assert_eq!(pictures.order, ["-a.exr", "+a.exr"]);
    let shown = &pictures.shown["a.exr"];
    assert_eq!((shown.width, shown.height), (150, 140));
    shown.assert_is(&directory.join("a.exr"), [0, 0, 150, 140]);
    // It changes nothing of the picture
    assert_eq!(run(&directory, "render ball.toml --size 150x140 --spp 3 -o b.png -q").status.code(), Some(0));
    assert!(
        std::fs::read(directory.join("a.png")).unwrap() == std::fs::read(directory.join("b.png")).unwrap()
    );
}

#[test]
fn tev_shows_a_region_in_its_place() {
    let (_keep, directory) = directory_with_ball();
    let (port, tev) = tev();
    let words = format!("render ball.toml --tev=localhost:{port} --region 7,3,33,20 --spp 2 -o a.exr -q");
    assert_eq!(run(&directory, &words).status.code(), Some(0));
    let shown = &tev.join().unwrap().shown["a.exr"];
    assert_eq!((shown.width, shown.height), (40, 24));
    shown.assert_is(&directory.join("a.exr"), [7, 3, 26, 17]);
}

#[test]
fn tev_shows_each_of_several_models() {
    let (_keep, directory) = directory_with_ball();
    let (port, tev) = tev();
    let words =
        format!("render ball.toml --subsurface dipole,none --tev=127.0.0.1:{port} --spp 2 -o both -q");
    let output = run(&directory, &words);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let pictures = tev.join().unwrap();
    let files = ["dipole.exr", "none.exr"].map(|name| Path::new("both").join(name));
    assert_eq!(pictures.shown.len(), 2);
    for file in files {
        pictures.shown[file.to_str().unwrap()].assert_is(&directory.join(&file), [0, 0, 40, 24]);
    }
}

#[test]
fn tev_sees_the_picture_grow() {
    let (_keep, directory) = directory_with_ball();
    let (port, tev) = tev();
    let words = format!("render ball.toml --tev=127.0.0.1:{port} --size 16x16 --time 2.5 -o a.exr -q");
    assert_eq!(run(&directory, &words).status.code(), Some(0));
    let shown = &tev.join().unwrap().shown["a.exr"];
    shown.assert_is(&directory.join("a.exr"), [0, 0, 16, 16]);
    // Four times, and once in the end; a machine with more to do is late
    assert!((2..=6).contains(&shown.updates_of_corner), "{} states", shown.updates_of_corner);
}

#[test]
fn tev_that_is_not_there_is_an_error_before_the_work() {
    let (_keep, directory) = directory_with_ball();
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    for models in ["dipole", "dipole,none"] {
        let output =
            run(&directory, &format!("render ball.toml --tev=127.0.0.1:{port} --subsurface {models}"));
        assert_eq!(output.status.code(), Some(2));
        let message = stderr(&output);
        assert!(message.contains(&format!("--tev: there is no tev at 127.0.0.1:{port}: ")), "{message}");
        assert!(message.contains("start tev first"), "{message}");
        assert_eq!(files(&directory), ["ball.toml"]);
    }
    let output = run(&directory, "render ball.toml --tev=here");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("an address is HOST:PORT, like 127.0.0.1:14158"), "{}", stderr(&output));
}

#[test]
fn tev_that_goes_stops_nothing() {
    let (_keep, directory) = directory_with_ball();
    let (port, tev) = server(|mut stream| drop(packet(&mut stream)));
    // The system notices at the second packet after it has gone
    let words = format!("render ball.toml --tev=127.0.0.1:{port} --size 300x300 --time 1.5 -o a.exr -q");
    let output = run(&directory, &words);
    tev.join().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let message = stderr(&output);
    assert!(message.starts_with(&format!("note: the tev at 127.0.0.1:{port} is gone: ")), "{message}");
    assert_eq!(message.matches("note").count(), 1, "{message}");
    assert_eq!(files(&directory), ["a.exr", "a.exr.checkpoint", "a.png", "ball.toml"]);
}

#[test]
fn tev_that_reads_nothing_stops_nothing() {
    let (_keep, directory) = directory_with_ball();
    let (until, wait) = std::sync::mpsc::channel::<()>();
    let (port, tev) = server(move |stream| {
        let _ = wait.recv();
        drop(stream);
    });
    // More than the system takes for a connection
    let words = format!(
        "render ball.toml --subsurface none --tev=127.0.0.1:{port} --size 1600x1200 --spp 1 -o a.png -q"
    );
    let output = run(&directory, &words);
    drop(until);
    tev.join().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let message = stderr(&output);
    assert!(message.contains(&format!("the tev at 127.0.0.1:{port} reads too slowly")), "{message}");
    assert_eq!(files(&directory), ["a.png", "ball.toml"]);
}
