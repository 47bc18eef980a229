//! Pieces of samples that other workers trace.
//!
//! Each has the same scene and has heard the same messages, and gives back samples of whole blocks. The film adds them in the
//! order that it would have traced them in, so a picture has the same bits whoever traced what; a piece that is lost costs time
//! alone, as the engine traces from the first block on whatever is lacking, while pieces are dealt from the last.

use bytemuck::{Pod, Zeroable, bytes_of, pod_read_unaligned};
use translucid_render::TracedBlock;

use super::{Engine, Work};

/// Blocks of a piece: a worker traces them in about 0.1 s.
const BLOCKS: u32 = 16;
/// Samples that are dealt beyond the first that is lacking.
const AHEAD: u32 = 2;

/// Blocks of a sample that a worker is to trace.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct Piece {
    film: u32,
    side: u32,
    number: u32,
    from: u32,
    to: u32,
}

/// What was dealt of a film.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dealt {
    /// Number of the film, which pieces repeat.
    film: u32,
    /// Number of the sample, and its blocks that are left, from the first on.
    number: u32,
    left: u32,
}

impl Dealt {
    /// Nothing of the film of this number, whose first sample has so many blocks.
    pub(super) fn nothing(film: u32, blocks: usize) -> Self {
        Self { film, number: 0, left: blocks as u32 }
    }

    /// Number of the film.
    pub(super) fn film(&self) -> u32 {
        self.film
    }

    /// The next piece of samples from `first` to `end`, of which `blocks` gives the number of blocks.
    fn next(&mut self, side: usize, first: u32, end: u32, blocks: impl Fn(u32) -> usize) -> Option<Piece> {
        while self.left == 0 || self.number < first {
            let number = first.max(self.number + 1);
            if number >= end {
                return None;
            }
            (self.number, self.left) = (number, blocks(number) as u32);
        }
        let to = self.left;
        self.left = to.saturating_sub(BLOCKS);
        Some(Piece { film: self.film, side: side as u32, number: self.number, from: self.left, to })
    }
}

impl Engine<'_> {
    /// The next piece for another worker, as bytes; none where all that is due is dealt, or the engine alone can do it.
    pub(crate) fn deal(&mut self) -> Option<Vec<u8>> {
        self.follow();
        let Work::Samples(side) = self.next_work() else { return None };
        if self.is_for_script(side) {
            return None;
        }
        let work = self.sides[side].as_mut()?;
        let first = work.film.samples();
        let end = work.goal().min(first.saturating_add(1 + AHEAD));
        let view = &work.view;
        let piece = work.dealt.next(side, first, end, |number| view.block_count(number))?;
        Some(bytes_of(&piece).to_vec())
    }

    /// Takes a piece and its samples, unless the film is another one by now.
    pub(crate) fn receive(&self, bytes: &[u8]) {
        let Some((piece, blocks)) = split(bytes) else { return };
        let work = self.sides.get(piece.side as usize).and_then(Option::as_ref);
        if let Some(work) = work.filter(|work| work.dealt.film == piece.film) {
            TracedBlock::read_all(blocks).into_iter().for_each(|block| work.film.give(block));
        }
    }

    /// Traces a piece for another worker: the piece again, and its samples.
    pub(crate) fn trace(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.follow();
        let mut traced = bytes.to_vec();
        if let Some((piece, _)) = split(bytes) {
            self.prepare(piece.side as usize);
            if let Some(work) = &self.sides[piece.side as usize] {
                let range = piece.from as usize..piece.to as usize;
                let blocks = self.prepared.trace_blocks(&work.view, piece.number, range);
                blocks.iter().for_each(|block| block.append_to(&mut traced));
            }
        }
        traced
    }
}

/// A piece, and what follows it.
fn split(bytes: &[u8]) -> Option<(Piece, &[u8])> {
    let (piece, rest) = bytes.split_at_checked(size_of::<Piece>())?;
    Some((pod_read_unaligned(piece), rest)).filter(|(piece, _): &(Piece, _)| piece.side < 2)
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::atomic::AtomicBool;
    use std::time::Duration;

    use translucid_load::{ExtendedBase, LoadOptions, SceneFile};
    use translucid_render::{FilmSums, PreparedScene};
    use translucid_scene::Scene;

    use super::*;
    use crate::message::Side;
    use crate::settings::{Devices, Settings};
    use crate::shared::Shared;

    const BALL: &str = "unit = 'cm'\nfilm.size = [70, 50]\nintegrator.samples_per_pixel = 6\nenvironment.radiance = 1\n\
        [[object]]\nname = 'ball'\nshape = 'sphere'\nradius = 1\nmaterial = 'wax'\n\
        [[material]]\nname = 'wax'\nsubsurface_weight = 1\nsubsurface_color = 0.8\nsubsurface_radius = 0.1\n\
        subsurface_model = 'random-walk'\n";

    fn shared(scene: &PreparedScene) -> Shared {
        let settings = Settings {
            name: String::from("ball"),
            base: ExtendedBase::default(),
            load_base: Box::new(|_| Ok(Scene::default())),
            mesh: None,
            is_metered: false,
            command: String::new(),
            options: String::new(),
            devices: Devices::default(),
        };
        Shared::new(scene.scene(), scene.picker(), Vec::new(), settings).unwrap()
    }

    /// The finished film in slices of a block, and how many of the pieces `trace` was given.
    fn film(slice: Duration, trace: &mut dyn FnMut(Vec<u8>) -> Option<Vec<u8>>) -> (FilmSums, usize) {
        let quit = AtomicBool::new(false);
        let file = SceneFile::parse(BALL, Path::new("ball.toml")).unwrap();
        let prepared =
            PreparedScene::new(file.load(&LoadOptions::default(), &mut Vec::new()).unwrap()).unwrap();
        let shared = shared(&prepared);
        let mut engine = Engine::new(&shared, prepared, &quit);
        let mut pieces = 0;
        while engine.step(Some(slice)) != Some(Duration::MAX) {
            if let Some(piece) = engine.deal() {
                pieces += 1;
                trace(piece).into_iter().for_each(|traced| engine.receive(&traced));
            }
        }
        let film = shared.side(Side::A).unwrap().film;
        let sums = film.sums().clone();
        (sums, pieces)
    }

    #[test]
    fn picture_has_the_same_bits_whoever_traced_what() {
        let (alone, _) = film(Duration::MAX, &mut |_| None);
        assert!(alone.samples() == 6 && alone.radiance(35, 25)[0] > 0.1);
        let is_same = |other: &FilmSums| {
            let pixels = || (0..50).flat_map(|y| (0..70).map(move |x| (x, y)));
            pixels().all(|(x, y)| alone.mean(x, y).map(f64::to_bits) == other.mean(x, y).map(f64::to_bits))
        };
        // Pieces that get lost are traced by the engine
        let (sliced, _) = film(Duration::ZERO, &mut |_| None);
        assert!(is_same(&sliced));
        let quit = AtomicBool::new(false);
        let file = SceneFile::parse(BALL, Path::new("ball.toml")).unwrap();
        let prepared =
            PreparedScene::new(file.load(&LoadOptions::default(), &mut Vec::new()).unwrap()).unwrap();
        let other_shared = shared(&prepared);
        let mut other = Engine::new(&other_shared, prepared, &quit);
        let mut count = 0;
        let (shared, pieces) = film(Duration::ZERO, &mut |piece| {
            count += 1;
            // Every third gets lost
            (count % 3 > 0).then(|| other.trace(&piece))
        });
        assert!(is_same(&shared) && pieces > 5, "{pieces} pieces");
    }

    #[test]
    fn pieces_are_all_blocks_of_each_sample_from_the_last_on() {
        let mut dealt = Dealt::nothing(7, 40);
        let mut pieces = Vec::new();
        while let Some(piece) = dealt.next(1, 0, 3, |_| 20) {
            assert_eq!((piece.film, piece.side), (7, 1));
            pieces.push((piece.number, piece.from, piece.to));
        }
        assert_eq!(
            pieces,
            [(0, 24, 40), (0, 8, 24), (0, 0, 8), (1, 4, 20), (1, 0, 4), (2, 4, 20), (2, 0, 4)]
        );
        // Samples that the film has by now are left out
        let piece = dealt.next(1, 9, 12, |_| 20).unwrap();
        assert_eq!((piece.number, piece.from, piece.to), (9, 4, 20));
        assert_eq!(dealt.next(1, 11, 12, |_| 20).unwrap().number, 11);
    }
}
