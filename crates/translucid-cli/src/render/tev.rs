//! `--tev`: the picture as it grows, in a running tev.
//!
//! A thread of its own looks at the film now and then and sends what has changed, a block at a time. A tev that reads
//! slowly gets fewer states of the picture.

mod packet;

use std::io::{self, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use translucid_image::PixelRect;
use translucid_render::{LiveFilm, TILE_SIZE};

use super::showing::{Screen, Showing};
use crate::failure::Failure;
use crate::messages;

/// Where tev listens unless it is told otherwise.
pub(crate) const DEFAULT_ADDRESS: &str = "127.0.0.1:14158";

/// Edge of the blocks that a picture is sent in, as tev's own client has it.
const BLOCK: u32 = 128;
/// A tile of the film lies in one block.
const _: () = assert!(BLOCK.is_multiple_of(TILE_SIZE));
/// Longest that tev may take for the connection.
const CONNECT_LIMIT: Duration = Duration::from_secs(3);
/// Longest that tev may take for a block.
const WRITE_LIMIT: Duration = Duration::from_secs(3);
/// Longest that the last state of a picture may take.
const LAST_LIMIT: Duration = Duration::from_secs(15);

/// A running tev, as far as it still listens.
#[derive(Clone, Debug)]
pub(crate) struct Tev {
    address: String,
    stream: Arc<Mutex<Option<TcpStream>>>,
}

impl Tev {
    /// Connects to a tev that is running.
    ///
    /// # Errors
    /// None listens there.
    pub(crate) fn connect(address: &str) -> Result<Self, Failure> {
        let stream = connect(address).map_err(|error| {
            let message = format!("--tev: there is no tev at {address}: {error}");
            Failure::input(message).with_help("start tev first, or say where it listens with --tev=HOST:PORT")
        })?;
        Ok(Self { address: address.to_owned(), stream: Arc::new(Mutex::new(Some(stream))) })
    }

    /// Shows a film as it grows, in the place of a picture of the same name; `place` is the film's in a picture of a
    /// size.
    ///
    /// # Errors
    /// The thread cannot be started.
    pub(crate) fn show(
        &self,
        name: &str,
        film: Arc<LiveFilm>,
        (place, size): (PixelRect, [u32; 2]),
    ) -> Result<Showing, Failure> {
        let screen = TevScreen { tev: self.clone(), name: name.to_owned(), film, place, size, shown: 0 };
        Showing::start(screen)
            .map_err(|error| Failure::work(format!("--tev: cannot start a thread: {error}")))
    }
}

fn connect(address: &str) -> io::Result<TcpStream> {
    let mut failure = io::Error::other("the name has no address");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT_LIMIT) {
            Ok(stream) => {
                stream.set_write_timeout(Some(WRITE_LIMIT))?;
                return Ok(stream);
            }
            Err(error) => failure = error,
        }
    }
    Err(failure)
}

/// A picture in a tev.
struct TevScreen {
    tev: Tev,
    name: String,
    film: Arc<LiveFilm>,
    /// The film's place in the picture.
    place: PixelRect,
    /// Width and height of the picture.
    size: [u32; 2],
    /// The film's change that was shown last.
    shown: u64,
}

impl Screen for TevScreen {
    const NAME: &'static str = "tev";
    const INTERVAL: Duration = Duration::from_millis(500);

    fn begin(&mut self) {
        self.send(&packet::close_image(&self.name), None);
        self.send(&packet::create_image(&self.name, self.size), None);
    }

    fn show(&mut self, is_to_stop: &mut dyn FnMut() -> bool) {
        self.show_changes(None, is_to_stop);
    }

    fn finish(&mut self) {
        self.show_changes(Instant::now().checked_add(LAST_LIMIT), || false);
    }
}

impl TevScreen {
    /// Sends all blocks that have changed, unless it is to stop on the way.
    fn show_changes(&mut self, deadline: Option<Instant>, mut is_to_stop: impl FnMut() -> bool) {
        let change = self.film.changes();
        let PixelRect { width, height, .. } = self.place;
        let mut is_changed = vec![false; blocks([width, height]).count()];
        for tile in self.film.tiles_changed_since(self.shown) {
            is_changed[(tile.top / BLOCK * width.div_ceil(BLOCK) + tile.left / BLOCK) as usize] = true;
        }
        let changed = blocks([width, height]).zip(is_changed).filter(|(_, is_changed)| *is_changed);
        for (block, _) in changed {
            let packet = self.packet_of(block);
            if is_to_stop() || !self.send(&packet, deadline) {
                return;
            }
        }
        self.shown = change;
    }

    /// The block in its place in the picture; nothing is added to the film meanwhile.
    fn packet_of(&self, block: PixelRect) -> Vec<u8> {
        let rect = PixelRect { left: self.place.left + block.left, top: self.place.top + block.top, ..block };
        let sums = self.film.sums();
        packet::update_image(&self.name, rect, block.pixels().map(|(x, y)| sums.rgba(x, y)))
    }

    /// Whether tev has taken a packet; if not it is given up, with a note.
    fn send(&self, packet: &[u8], deadline: Option<Instant>) -> bool {
        let mut stream = self.tev.stream.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(open) = stream.as_mut() else { return false };
        let limit = Instant::now().checked_add(WRITE_LIMIT).into_iter().chain(deadline).min();
        let Err(error) = write_until(open, packet, limit) else { return true };
        *stream = None;
        let reason = match error.kind() {
            io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock => String::from("reads too slowly"),
            _ => format!("is gone: {error}"),
        };
        messages::print_note(&format!(
            "the tev at {} {reason}; it gets no further updates",
            self.tev.address
        ));
        false
    }
}

/// Writes all bytes, before a time.
fn write_until(stream: &mut TcpStream, mut bytes: &[u8], limit: Option<Instant>) -> io::Result<()> {
    while !bytes.is_empty() {
        if limit.is_some_and(|limit| Instant::now() > limit) {
            return Err(io::ErrorKind::TimedOut.into());
        }
        match stream.write(bytes) {
            Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
            Ok(count) => bytes = &bytes[count..],
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// A picture cut into blocks, row by row.
fn blocks([width, height]: [u32; 2]) -> impl Iterator<Item = PixelRect> {
    let starts = |length: u32| (0..length).step_by(BLOCK as usize);
    starts(height).flat_map(move |top| {
        starts(width).map(move |left| PixelRect {
            left,
            top,
            width: BLOCK.min(width - left),
            height: BLOCK.min(height - top),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_hold_every_pixel_once() {
        for size in [[1, 1], [128, 128], [129, 300], [1000, 5]] {
            let mut pixels: Vec<_> =
                blocks(size).flat_map(|block| block.pixels().collect::<Vec<_>>()).collect();
            pixels.sort_unstable();
            let mut expected: Vec<_> = PixelRect::whole(size).pixels().collect();
            expected.sort_unstable();
            assert_eq!(pixels, expected, "{size:?}");
        }
    }
}
