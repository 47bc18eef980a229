//! Exits on their way from the kernel to the caller.

use fearless_simd::Simd;
use fearless_simd::prelude::*;

use super::lanes::{Floats, Words};
use super::random::LANES;
use super::{PhotonExit, Side};

/// Exits that are handed on at a time.
const EXITS: usize = 1024;

/// Buffered exits, as a structure of arrays.
pub(super) struct ExitBuffer<'a> {
    x: [f32; EXITS + LANES],
    y: [f32; EXITS + LANES],
    cos_theta: [f32; EXITS + LANES],
    order: [u32; EXITS + LANES],
    transmitted: [u32; EXITS + LANES],
    count: usize,
    /// Number of exits that have been handed on.
    pub(super) total: u64,
    batch: Vec<PhotonExit>,
    hand_on: &'a mut dyn FnMut(&[PhotonExit]),
}

impl<'a> ExitBuffer<'a> {
    pub(super) fn new(hand_on: &'a mut dyn FnMut(&[PhotonExit])) -> Self {
        Self {
            x: [0.0; EXITS + LANES],
            y: [0.0; EXITS + LANES],
            cos_theta: [0.0; EXITS + LANES],
            order: [0; EXITS + LANES],
            transmitted: [0; EXITS + LANES],
            count: 0,
            total: 0,
            batch: Vec::with_capacity(EXITS + LANES),
            hand_on,
        }
    }

    /// Adds the first `count` lanes.
    #[inline(always)]
    pub(super) fn push<S: Simd>(
        &mut self,
        [x, y, cos_theta]: [Floats<S>; 3],
        [order, transmitted]: [Words<S>; 2],
        count: usize,
    ) {
        let range = self.count..self.count + LANES;
        x.store_slice(&mut self.x[range.clone()]);
        y.store_slice(&mut self.y[range.clone()]);
        cos_theta.store_slice(&mut self.cos_theta[range.clone()]);
        order.store_slice(&mut self.order[range.clone()]);
        transmitted.store_slice(&mut self.transmitted[range]);
        self.added(count);
    }

    /// Adds one.
    #[inline(always)]
    pub(super) fn push_one(&mut self, x: f32, y: f32, cos_theta: f32, order: u32, transmitted: u32) {
        let i = self.count;
        self.x[i] = x;
        self.y[i] = y;
        self.cos_theta[i] = cos_theta;
        self.order[i] = order;
        self.transmitted[i] = transmitted;
        self.added(1);
    }

    #[inline(always)]
    fn added(&mut self, count: usize) {
        self.count += count;
        if self.count >= EXITS {
            self.flush();
        }
    }

    /// Hands on what there is.
    #[inline(never)]
    pub(super) fn flush(&mut self) {
        self.batch.clear();
        for i in 0..self.count {
            self.batch.push(PhotonExit {
                x: self.x[i],
                y: self.y[i],
                cos_theta: self.cos_theta[i],
                order: self.order[i],
                side: if self.transmitted[i] == 0 { Side::Reflected } else { Side::Transmitted },
            });
        }
        self.total += self.count as u64;
        self.count = 0;
        (self.hand_on)(&self.batch);
    }
}
