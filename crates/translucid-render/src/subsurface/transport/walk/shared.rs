//! Light inside a body, shared between the walks of a block of pixels.
//!
//! Walks that have just collided for the first time, at z_j, lie closer together than their next flights are long: where
//! the flight of one of them ends, y_i, those of the others could have ended, too. The light from there is the same for all
//! of them (so the phase function has to be isotropic), and each gathers it from every walk (see
//! [`gathering`](super::super::gathering)), with per channel
//!
//! ```text
//! K(y) = σ_t e^{−σ_t d} / (4π d²) V(y)        at a collision, d = |y − z_j|
//! K(y) = e^{−σ_t d} cos θ / (4π d²) V(y)      on a matte surface that light enters
//! ```
//!
//! and with g the density of the walk's own flight, K without V mixed over the channels. V is 1 where y is visible from z_j
//! inside the body, else 0. So that g does not have to know V, a flight that leaves the body does not end there: if it comes
//! back to the body behind a gap, the light that it finds there serves the collisions that see it.
//!
//! The light of a second collision y_i is gathered in the same way from the ends of all walks' third flights, which start
//! at y_1 … y_n, and so on for some generations; the rest of a walk belongs to it alone. Given where the collisions of a
//! generation are, flights from there do not depend on each other, so that the mean stays exact, from the last generation
//! back to the first.
//! A walk may end at random after a collision, with any probability: that collision gathers all the same.
//!
//! Between matte surfaces every flight ends at a place that is shared. So ∫ K is 1 in each channel, and the part of it
//! about on [the exit's plane](ExitPlane) is known, too. Light like that which neighboring parts of the block have found
//! inside and on surfaces is expected, and only the difference from it is gathered.
//!
//! A clear surface lets in light from one direction only: there a walk's own path goes on outside, and only collisions are
//! shared. Light that is sampled at a first collision has a first flight of its own.
//!
//! All flights of these generations [lean](Tilt) back to the surface.

use std::sync::atomic::AtomicBool;

use glam::Vec3;
use translucid_profile::split_mix::split_mix;
use translucid_scene::WalkSurface;

use super::Walks;
use super::common_medium::{CommonMedia, Media, Medium, WalkKind};
use super::exit_plane::ExitPlane;
use super::flight::Flights;
use super::flight_kernel::{FlightKernel, FlightPlace};
use super::state::Walk;
use super::tilt::Tilt;
use crate::ray::{Body, FlightEnd, Hit, Inside};
use crate::sampling::{Reserved, Sampler};
use crate::subsurface::entry_point::EntryPoint;
use crate::subsurface::exit_point::ExitPoint;
use crate::subsurface::transport::Tracer;
use crate::subsurface::transport::gathering::full_sum::{FullReceiver, FullSums};
use crate::subsurface::transport::gathering::{
    Account, BlockReceiver, COORDINATES, ExitKind, FoundLight, Gathering,
};
use crate::subsurface::transport::shared::arrival_along;
use crate::world::{BlockPlace, COHORT_SIZE, Layer, PathState, World};

/// Longest mean free path, in pixels, from which on walks share between clear surfaces, and between matte ones.
///
/// Below, the flights of neighbors seldom end near each other. Measured on head, hand, marble and fruit.
const LEAST_PIXELS: [f32; 2] = [1.0, 0.5];

/// Lengths \[L\] whose inverse squares and their products are finite.
const USUAL_LENGTHS: std::ops::Range<f32> = 1e-5..1e5;

/// Least part of the brightest channel that every channel of a shared walk is worth: other walks may see more of a color.
const LEAST_CHANNEL: f32 = 0.03;

/// Width and height \[pixels\] of a part of a block whose walks share. Larger ones are worth less than the time that they take.
const PART: [u32; 2] = [COHORT_SIZE, COHORT_SIZE / 2];

/// How far from its own place a walk may go, over the longest mean free path, to find those that it shares with.
///
/// Parts have errors of their own, and with 0 their borders show where light comes from behind. Greater values bring less
/// close walks together, and pixels get noisier.
const SPREAD: f32 = 0.5;

/// Places along an exit's first flight at which its walk may collide first.
///
/// Two at most, or [`SharedWalk::of_first`] would not choose evenly between those of them that are in the body.
/// Measured on head and dragon: 0.85 to 0.96 times the error times CPU time of one; with three, 0.80 to 1.01 times.
const FIRST: usize = 2;

/// Generations of collisions that light is gathered at, at the most.
pub(super) const MOST_GENERATIONS: usize = 3;

/// Lights that are sampled where flights of each generation end at a matte surface: light that enters there serves all walks
/// nearby.
///
/// Errors are 0.87 on the head and 0.99 on the dragon of those with one, for a few percent of the time.
const LIGHTS: [u16; MOST_GENERATIONS] = [2, 2, 1];

/// The place of a walk that shares, in its block of pixels.
#[derive(Clone, Copy)]
pub(super) struct SharedPlace {
    /// Number of its sample.
    sample: usize,
    /// Column and row of the part that it shares with.
    part: [usize; 2],
    /// The medium that it shares in.
    medium: Medium,
    media: Media,
}

/// A walk that shares: the exit where it begins, its place, and random numbers.
pub(super) struct SharedWalk<'s, 'a> {
    pub(super) world: &'a World,
    pub(super) exit: &'s ExitPoint<'s>,
    pub(super) place: SharedPlace,
    /// A number in [0, 1) that draws the first flight, stratified against those of the pixel's other samples.
    pub(super) of_first: f32,
    pub(super) of_light: LightNumbers,
    /// Numbers for the direction after a first collision, the length of the flight, and the place to test for visibility.
    pub(super) of_flight: [f32; 4],
}

impl SharedWalk<'_, '_> {
    /// Returns `true` if walks end at a matte surface.
    fn is_matte(&self) -> bool {
        matches!(self.of_light, LightNumbers::AtSurface(_))
    }
}

/// Throughput of a path below which it does not share.
const LEAST_THROUGHPUT: f32 = 1e-15;

/// Throughput below which nothing is left of a walk.
const LEAST_WORTH: f32 = 1e-20;

/// Random numbers of the light that a walk meets first.
pub(super) enum LightNumbers {
    /// For light scattered at the first collision.
    AtCollision([f32; 4]),
    /// For light that enters through a matte surface, and for the path from there.
    AtSurface([Reserved; 2]),
}

/// The continuation of walks from a collision.
pub(super) trait WalkContinuation<'a> {
    /// Generations of collisions that light is gathered at, of [`MOST_GENERATIONS`].
    const GENERATIONS: usize;

    /// How far flights lean back to the surface, see [`Tilt::toward`].
    const LEANING: f32;

    /// Probability with which `turn` goes on.
    fn survival(&self, walk: &Walk<'a>) -> f32;

    /// Adds light at a collision and turns there: a number for the next flight's length, or `None` where the walk ends.
    fn turn(&mut self, walk: &mut Walk<'a>, path: &mut PathState, sampler: &mut Sampler) -> Option<f32>;

    /// Follows a walk to its end, first by the number `flight`; true if its path goes on outside.
    fn finish(
        &mut self,
        walk: &mut Walk<'a>,
        path: &mut PathState,
        sampler: &mut Sampler,
        flight: f32,
    ) -> bool;

    /// A random number for any other draw.
    fn number(&mut self) -> f32;
}

/// The collisions of a block, by generation.
#[derive(Default)]
pub(in crate::subsurface::transport) struct SharedCollisions<'a> {
    generations: [Gathering<Collision<'a>>; MOST_GENERATIONS],
    media: CommonMedia,
}

impl SharedCollisions<'_> {
    /// [`Gathering::resolve`] of the first generation, with all light that comes to the others.
    pub(in crate::subsurface::transport) fn resolve(
        &mut self,
        stop: &AtomicBool,
        add: impl FnMut(usize, Layer, Vec3),
    ) {
        for next in (1..MOST_GENERATIONS).rev() {
            let (before, from) = self.generations.split_at_mut(next);
            let found_before = &mut before[next - 1];
            from[0].resolve(stop, |index, _, light| found_before.found_mut(index).light += light);
        }
        self.generations[0].resolve(stop, add);
        self.media.clear();
    }

    /// Forgets all collisions.
    pub(in crate::subsurface::transport) fn clear(&mut self) {
        self.generations.iter_mut().for_each(Gathering::clear);
        self.media.clear();
    }
}

/// Properties common to walks that share: their kind, the bits of σ_t and α of their common medium, and their part of the block.
type SharingKind = (WalkKind, [[u32; 3]; 2], [usize; 2]);

/// Returns `true` if one part of a block gives the other the light to expect: parts above and below each other in one
/// generation, parts beside each other in the next.
///
/// They alternate, so that the light that a part is given in one generation does not depend on that part by way of the next.
fn tell_each_other(a: [usize; 2], b: [usize; 2], generation: usize) -> bool {
    let apart = [a[0].abs_diff(b[0]), a[1].abs_diff(b[1])];
    apart == if generation.is_multiple_of(2) { [0, 1] } else { [1, 0] }
}

/// A collision that light comes to from those of the next generation.
pub(in crate::subsurface::transport) struct Collision<'a> {
    kind: SharingKind,
    generation: usize,
    account: Account,
    body: Body<'a>,
    at: Inside,
    kernel: FlightKernel,
    plane: ExitPlane,
    /// All of its flights end where light is shared: between matte surfaces of a bounded body.
    is_complete: bool,
}

/// Light where a flight from a collision ends.
#[derive(Clone, Copy)]
pub(in crate::subsurface::transport) struct FlightLight {
    place: FlightPlace,
    /// Number of ends of this kind that the flight has.
    own_weight: f32,
    /// Radiance that comes from there.
    light: Vec3,
}

/// Light that a flight from a collision finds.
struct FlightEnds {
    /// Where it ends, inside and on a matte surface.
    found: [Option<FlightLight>; 2],
    /// Light that has come through a clear surface, times the walk's throughput: it serves no other walk.
    passed: Vec3,
    /// All light on the walk's own way, through its own medium and through the common one, times the walk's throughput; without
    /// use where both are one.
    of_path: [Vec3; 2],
}

impl FlightEnds {
    const NONE: Self = Self { found: [None; 2], passed: Vec3::ZERO, of_path: [Vec3::ZERO; 2] };
}

impl FoundLight for FlightLight {
    fn coordinates(&self) -> [f32; COORDINATES] {
        self.place.coordinates()
    }

    fn own_weight(&self) -> f32 {
        self.own_weight
    }

    fn light(&self) -> Vec3 {
        self.light
    }

    fn normal(&self) -> Vec3 {
        self.place.normal
    }
}

impl BlockReceiver for Collision<'_> {
    type Kind = SharingKind;
    type FoundLight = FlightLight;
    type Sums = FullSums<FlightLight>;

    fn kind(&self) -> SharingKind {
        self.kind
    }

    fn account(&self) -> &Account {
        &self.account
    }

    fn fill(&self, places: [&[f32]; COORDINATES], row: &mut [f32], sums: &mut [f32]) {
        self.kernel.fill(places, row, sums);
    }

    fn color(&self) -> Vec3 {
        self.account.throughput
    }
}

impl FullReceiver for Collision<'_> {
    fn is_hidden(&self, found: &FlightLight) -> bool {
        !self.body.connects(self.at, found.place.position, found.place.normal)
    }

    fn is_complete(&self) -> bool {
        self.is_complete
    }

    fn tells_of(&self, other: &Self) -> bool {
        let medium = |one: &Self| {
            let [sigma_t, alpha] = one.kind.1.map(|bits| Vec3::from_array(bits.map(f32::from_bits)));
            Medium { sigma_t, alpha }
        };
        self.kind.0 == other.kind.0
            && tell_each_other(self.kind.2, other.kind.2, self.generation)
            && medium(self).is_near(&medium(other))
    }

    fn expected_part(&self) -> Vec3 {
        self.plane.flights_beyond(&self.kernel)
    }

    fn fill_expected_part(&self, places: [&[f32]; COORDINATES], split: usize, part: &mut [f32]) {
        self.plane.fill(&self.kernel, places, split, part);
    }
}

impl<'a> Walk<'a> {
    /// The place in which the walk of a path shares from its first collision on; `None` if it may not share.
    pub(super) fn shared_place<T: Tracer<'a>>(
        &self,
        tracer: &mut T,
        walks: &Walks,
        path: &PathState,
        sampler: &Sampler,
        (exit, place): (&ExitPoint<'_>, BlockPlace),
    ) -> Option<SharedPlace> {
        let sigma_t = self.flights.sigma_t();
        let longest = (0..3).filter(|&c| sigma_t[c] > 0.0).map(|c| sigma_t[c].recip()).fold(0.0, f32::max);
        let usual = |c: usize| sigma_t[c] == 0.0 || USUAL_LENGTHS.contains(&sigma_t[c].recip());
        let pixels = longest / tracer.pixel_width().at(path.sample.depth);
        let is_matte = walks.medium.surface != WalkSurface::Clear;
        let may_share = self.phase.is_isotropic()
            && self.most_events > MOST_GENERATIONS as u32
            && (0..3).all(usual)
            && self.throughput.max_element() > LEAST_THROUGHPUT
            && pixels >= LEAST_PIXELS[usize::from(is_matte)];
        if !may_share {
            return None;
        }
        let part = place.rectangle(PART, place.offset(SPREAD * pixels, sampler.fork()));
        let own = Medium { sigma_t, alpha: self.alpha };
        let medium = if walks.is_even {
            own
        } else {
            let kind = self.kind(exit, path, is_matte);
            tracer.scratch().collisions.media.choose(part, kind, own)?
        };
        Some(SharedPlace { sample: place.number, part, medium, media: Media::new(&own, &medium) })
    }

    fn kind(&self, exit: &ExitPoint<'_>, path: &PathState, is_matte: bool) -> WalkKind {
        (ExitKind::new(exit, path), self.most_events, is_matte)
    }

    /// Goes through the body with the light that the block shares. Returns where the body ends if some of the first flight
    /// gets there without a collision.
    pub(super) fn share<T: Tracer<'a>, W: WalkContinuation<'a>>(
        &mut self,
        tracer: &mut T,
        path: &mut PathState,
        sampler: &mut Sampler,
        sharing: &SharedWalk<'_, 'a>,
        onward: &mut W,
    ) -> Option<Hit> {
        let (within, part) = ((sharing.of_first * FIRST as f32).fract(), 1.0 / FIRST as f32);
        let alpha = (self.alpha * self.throughput).element_sum() / self.throughput.element_sum();
        self.tilt = Tilt::toward(sharing.exit.point.geometric_normal * sharing.exit.side, W::LEANING, alpha);
        if let LightNumbers::AtCollision(u) = sharing.of_light {
            self.add_light_at_first_collision(sharing.world, path, u);
        }
        let (mut collided, mut count) = ([*self; FIRST], 0);
        let mut end = None;
        let mut passed = Vec3::ZERO;
        for k in 0..FIRST {
            let mut walk = *self;
            let hit = walk.fly((k as f32 + within) * part);
            walk.throughput *= part;
            if hit.is_some() {
                end = hit;
                passed += walk.throughput;
            } else if walk.throughput.max_element() > 0.0 {
                collided[count] = walk;
                count += 1;
            }
        }
        if count > 0 {
            Self::gather(tracer, path, sampler, sharing, &collided[..count], onward);
        }
        self.throughput = passed;
        end
    }

    /// Leaves the light that comes to first collisions from where flights end to the block, and flies on from one of them.
    fn gather<T: Tracer<'a>>(
        tracer: &mut T,
        path: &mut PathState,
        sampler: &mut Sampler,
        sharing: &SharedWalk<'_, 'a>,
        collided: &[Self],
        onward: &mut impl WalkContinuation<'a>,
    ) {
        let count = collided.len() as f32;
        // If there are two: the one that a single flight by this number would have led to
        let mut walk = collided[((sharing.of_first * count) as usize).min(collided.len() - 1)];
        walk.throughput *= count;
        walk.alpha = sharing.place.media.alpha();
        let [a, b, of_flight, of_picks] = sharing.of_flight;
        walk.scatter([a, b]);
        let ends = walk.find(tracer, path, sampler, sharing, (0, of_flight), onward);
        let [own, common] = ends.of_path;
        path.add_to(path.layer_after(Layer::Subsurface), ends.passed + (own - common));
        let mut found = ends.found.into_iter().flatten();
        for (k, first) in collided.iter().enumerate() {
            let account = Account {
                sample: sharing.place.sample,
                layer: path.layer_after(Layer::Subsurface),
                throughput: first.throughput,
                random: (of_picks + k as f32 / count).fract(),
            };
            let collision = first.receiver(path, sharing, account, (0, 1.0 / count));
            tracer.scratch().collisions.generations[0].push(collision, found.by_ref());
        }
    }

    /// A collision of a generation that gathers light, and whose own flights are such a `share` of those by its throughput.
    fn receiver(
        &self,
        path: &PathState,
        sharing: &SharedWalk<'_, 'a>,
        account: Account,
        (generation, share): (usize, f32),
    ) -> Collision<'a> {
        let (exit, sigma_t) = (sharing.exit, self.flights.sigma_t());
        let SharedPlace { medium, part, .. } = sharing.place;
        let bits = [medium.sigma_t, medium.alpha].map(|v| v.to_array().map(f32::to_bits));
        let kind = (self.kind(exit, path, sharing.is_matte()), bits, part);
        let kernel = FlightKernel::new(self.at.position, sigma_t, self.throughput, self.tilt, share);
        let plane =
            ExitPlane::new(exit.point.position, exit.point.geometric_normal * exit.side, self.at.position);
        let is_complete = sharing.is_matte() && self.body.is_bounded();
        Collision { kind, generation, account, body: self.body, at: self.at, kernel, plane, is_complete }
    }

    /// Flies from a collision of a generation by the number `flight`, to light where the flight ends.
    fn find<T: Tracer<'a>>(
        mut self,
        tracer: &mut T,
        path: &mut PathState,
        sampler: &mut Sampler,
        sharing: &SharedWalk<'_, 'a>,
        (generation, flight): (usize, f32),
        onward: &mut impl WalkContinuation<'a>,
    ) -> FlightEnds {
        let world = sharing.world;
        let length = self.flights.sample(self.throughput, flight);

        // Find where the flight ends, and where it leaves the body: one of these places, should there be more
        let (mut end, mut ends, mut is_first) = (None, 0, true);
        let inside = match self.body.fly(self.at, self.direction, length) {
            FlightEnd::Inside(at) => Some(at),
            FlightEnd::Boundary { distance, hit } => {
                (end, ends) = (Some((distance, hit)), 1);
                let mut random = sampler.fork();
                self.body.behind(self.at, self.direction, distance, length, |distance, hit| {
                    ends += 1;
                    random = split_mix(random);
                    if sharing.is_matte() && random.is_multiple_of(ends) {
                        (end, is_first) = (Some((distance, hit)), false);
                    }
                })
            }
        };
        let is_inside = ends == 0;
        // First flights after a collision are through the own medium
        let (media, is_own) = (sharing.place.media, generation == 0);

        // Find the light there: light through a clear surface comes from one direction, and serves no other walk
        let mut found = FlightEnds::NONE;
        let scattered = inside.and_then(|at| {
            self.scattered_at(tracer, path, sampler, sharing, (generation, at, length), onward)
        });
        if let Some((scattered, of_path)) = scattered {
            found.found[0] = Some(scattered);
            if is_inside && media.differ() {
                let throughput = self.flights.collide(self.throughput, length);
                found.of_path = of_path.map(|light| throughput * light);
                found.of_path[0] *= if is_own { Vec3::ONE } else { media.colliding(length) };
            }
        }
        if let Some((distance, hit)) = end {
            let throughput = self.flights.pass(self.throughput, distance);
            if let LightNumbers::AtSurface(numbers) = sharing.of_light {
                let entry = EntryPoint::new(world, world.surface_point(&hit), self.side);
                let [of_light, of_direction] = numbers;
                let direct = entry.mean_direct_light(path.absorption, of_light, LIGHTS[generation]);
                let along = arrival_along(tracer, path, &entry, throughput, sampler, of_direction);
                // In its plane, which the flight's length is not exact enough for in a thin body
                let place = FlightPlace { position: entry.point.position, normal: self.body.normal(&hit) };
                let light = direct + along.light;
                found.found[1] = Some(FlightLight { place, own_weight: ends as f32, light });
                if is_first && media.differ() {
                    found.of_path = [throughput * light * ends as f32; 2];
                    found.of_path[0] *= if is_own { Vec3::ONE } else { media.passing(distance) };
                }
            } else {
                self.throughput = throughput;
                let mut branch = path.branch(Vec3::ONE);
                if self.leave(world, &mut branch, sharing.exit, &hit) {
                    tracer.follow(&mut branch, sampler);
                }
                found.passed = branch.sample.radiance();
                found.of_path[0] += found.passed * if is_own { Vec3::ONE } else { media.passing(distance) };
                found.of_path[1] += found.passed;
            }
        }
        found
    }

    /// Light that is scattered where a flight of this length from a generation ends: at a collision of the next generation,
    /// which light is gathered at, too, if it shares.
    fn scattered_at<T: Tracer<'a>, W: WalkContinuation<'a>>(
        &self,
        tracer: &mut T,
        path: &PathState,
        sampler: &mut Sampler,
        sharing: &SharedWalk<'_, 'a>,
        (generation, at, length): (usize, Inside, f32),
        onward: &mut W,
    ) -> Option<(FlightLight, [Vec3; 2])> {
        let own = self.flights.collide(self.throughput, length) * self.alpha;
        let scatters = self.alpha.cmpgt(Vec3::ZERO) & self.flights.sigma_t().cmpgt(Vec3::ZERO);
        let worth =
            Vec3::select(scatters, own.max(Vec3::splat(LEAST_CHANNEL * own.max_element())), Vec3::ZERO);
        if self.body.is_lost(&at) {
            return None;
        }
        let place = FlightPlace { position: at.position, normal: Vec3::ZERO };
        // A place without light counts, too, where light is expected
        if worth.max_element() <= LEAST_WORTH {
            return Some((FlightLight { place, own_weight: 1.0, light: Vec3::ZERO }, [Vec3::ZERO; 2]));
        }
        let next = generation + 1;
        // The weights of more tilted flights would add up to noise where light comes from behind
        let tilt = if next < W::GENERATIONS { self.tilt } else { Tilt::NONE };
        let SharedPlace { medium, media, .. } = sharing.place;
        let (events, flights) = (self.events + 1, Flights::new(medium.sigma_t));
        let collided = Self { at, tilt, throughput: worth, events, flights, media, ..*self };
        let mut walk = collided;
        let mut branch = path.branch(worth);
        let flight = onward.turn(&mut walk, &mut branch, sampler);
        // Light that comes there through the own medium and the common one, and that of it which is shared
        let (of_path, shared);
        if next < W::GENERATIONS {
            let ends = flight.map_or(FlightEnds::NONE, |flight| {
                walk.find(tracer, &mut branch, sampler, sharing, (next, flight), onward)
            });
            let here = branch.sample.radiance();
            (of_path, shared) = (ends.of_path.map(|light| light + here), here + ends.passed);
            let generations = &mut tracer.scratch().collisions.generations;
            let account = Account {
                sample: generations[generation].found_count(),
                layer: Layer::Subsurface,
                throughput: Vec3::select(scatters, medium.alpha, Vec3::ZERO),
                random: onward.number(),
            };
            let receiver = collided.receiver(path, sharing, account, (next, onward.survival(&collided)));
            generations[next].push(receiver, ends.found.into_iter().flatten());
        } else {
            if flight.is_some_and(|flight| onward.finish(&mut walk, &mut branch, sampler, flight)) {
                tracer.follow(&mut branch, sampler);
            }
            walk.media.weigh(branch.sample.radiance(), 0.0);
            of_path = walk.media.light(branch.sample.radiance());
            shared = of_path[1];
        }
        let scattered = |alpha: Vec3, light: Vec3| Vec3::select(scatters, alpha * light / worth, Vec3::ZERO);
        let light = scattered(medium.alpha, shared);
        let [own, common] = media.alphas();
        let of_path = [scattered(own, of_path[0]), scattered(common, of_path[1])];
        Some((FlightLight { place, own_weight: 1.0, light }, of_path))
    }
}
