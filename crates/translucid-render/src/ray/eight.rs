//! Eight numbers side by side: a vector of the processor, or loops that find the same bits.

use std::ops::{Add, Div, Mul, Sub};

/// Lanes of a vector.
pub(super) const LANES: usize = 8;

/// Eight numbers; comparisons are a bit for each lane.
pub(super) trait Eight:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The lesser of each two numbers; the second if one of them is none.
    fn lesser(self, other: Self) -> Self;
    /// The greater of each two numbers; the second if one of them is none.
    fn greater(self, other: Self) -> Self;
    /// The lesser of each two by their bits as signed integers, which most processors find sooner: the right one, but of two
    /// negative numbers either, as which −0 counts.
    fn lesser_bits(self, other: Self) -> Self;
    /// The greater of each two by their bits as signed integers: the right one, but of two negative numbers either.
    fn greater_bits(self, other: Self) -> Self;
    /// Whether the bits, as signed integers, are below the other's.
    fn is_below_bits(self, other: Self) -> u32;
    fn is_below(self, other: Self) -> u32;
    fn is_at_most(self, other: Self) -> u32;
    fn to_array(self) -> [f32; LANES];
}

/// Makes vectors of one kind: whoever has it may use the instructions behind them.
pub(super) trait Vectors: Copy {
    type Eight: Eight;

    fn splat(self, number: f32) -> Self::Eight;
    fn load(self, numbers: &[f32; LANES]) -> Self::Eight;
    /// For each lane the number in the lane that its three bits of `lanes` say, which begin with the lowest.
    fn pick(self, from: Self::Eight, lanes: u32) -> Self::Eight;
}

/// Loops over lanes, on every processor.
#[derive(Clone, Copy)]
pub(super) struct Loops;

#[derive(Clone, Copy)]
pub(super) struct LoopEight([f32; LANES]);

impl LoopEight {
    #[inline(always)]
    fn with(self, other: Self, of_lane: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|lane| of_lane(self.0[lane], other.0[lane])))
    }

    #[inline(always)]
    fn bits(self, other: Self, of_lane: impl Fn(f32, f32) -> bool) -> u32 {
        (0..LANES).fold(0, |bits, lane| bits | u32::from(of_lane(self.0[lane], other.0[lane])) << lane)
    }
}

impl Vectors for Loops {
    type Eight = LoopEight;

    #[inline(always)]
    fn splat(self, number: f32) -> LoopEight {
        LoopEight([number; LANES])
    }

    #[inline(always)]
    fn load(self, numbers: &[f32; LANES]) -> LoopEight {
        LoopEight(*numbers)
    }

    #[inline(always)]
    fn pick(self, from: LoopEight, lanes: u32) -> LoopEight {
        LoopEight(std::array::from_fn(|lane| from.0[(lanes >> (3 * lane)) as usize % LANES]))
    }
}

impl Eight for LoopEight {
    #[inline(always)]
    fn lesser(self, other: Self) -> Self {
        self.with(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn greater(self, other: Self) -> Self {
        self.with(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn lesser_bits(self, other: Self) -> Self {
        self.with(other, |a, b| if (a.to_bits() as i32) < b.to_bits() as i32 { a } else { b })
    }

    #[inline(always)]
    fn greater_bits(self, other: Self) -> Self {
        self.with(other, |a, b| if (a.to_bits() as i32) > b.to_bits() as i32 { a } else { b })
    }

    #[inline(always)]
    fn is_below_bits(self, other: Self) -> u32 {
        self.bits(other, |a, b| (a.to_bits() as i32) < b.to_bits() as i32)
    }

    #[inline(always)]
    fn is_below(self, other: Self) -> u32 {
        self.bits(other, |a, b| a < b)
    }

    #[inline(always)]
    fn is_at_most(self, other: Self) -> u32 {
        self.bits(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn to_array(self) -> [f32; LANES] {
        self.0
    }
}

macro_rules! loop_operator {
    ($($operator:ident $method:ident),*) => {$(
        impl $operator for LoopEight {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(other, |a, b| a.$method(b))
            }
        }
    )*};
}

loop_operator!(Add add, Sub sub, Mul mul, Div div);

#[cfg(target_arch = "x86_64")]
pub(super) use avx2::Avx2;

/// Nothing here has a `target_feature` of its own, with which it could not be told to always become part of its caller:
/// calls cost a fifth of all rays per second.
#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::{
        __m256, __m256i, _CMP_LE_OQ, _CMP_LT_OQ, _mm256_add_ps, _mm256_cmp_ps, _mm256_cmpgt_epi32,
        _mm256_div_ps, _mm256_max_epi32, _mm256_max_ps, _mm256_min_epi32, _mm256_min_ps, _mm256_movemask_ps,
        _mm256_mul_ps, _mm256_permutevar8x32_ps, _mm256_set1_epi32, _mm256_set1_ps, _mm256_srlv_epi32,
        _mm256_sub_ps,
    };

    use super::{Add, Div, Eight, LANES, Mul, Sub, Vectors};

    /// Vectors of a processor that has AVX2.
    #[derive(Clone, Copy)]
    pub(in crate::ray) struct Avx2(());

    impl Avx2 {
        /// # Safety
        /// The processor must have AVX2.
        #[inline(always)]
        pub(in crate::ray) unsafe fn new() -> Self {
            Self(())
        }
    }

    /// Only [`Avx2`] makes the first of them.
    #[derive(Clone, Copy)]
    pub(in crate::ray) struct Avx2Eight(__m256);

    impl Avx2Eight {
        #[inline(always)]
        fn bits(self) -> __m256i {
            bytemuck::cast(self.0)
        }
    }

    impl Vectors for Avx2 {
        type Eight = Avx2Eight;

        #[inline(always)]
        fn splat(self, number: f32) -> Avx2Eight {
            // SAFETY: who has an `Avx2` has said that there is AVX2, and the instructions touch no memory.
            Avx2Eight(unsafe { _mm256_set1_ps(number) })
        }

        #[inline(always)]
        fn load(self, numbers: &[f32; LANES]) -> Avx2Eight {
            Avx2Eight(bytemuck::cast(*numbers))
        }

        #[inline(always)]
        fn pick(self, from: Avx2Eight, lanes: u32) -> Avx2Eight {
            let shifts = bytemuck::cast([0_i32, 3, 6, 9, 12, 15, 18, 21]);
            // SAFETY: as in `splat`; of each index the instruction takes the lowest three bits.
            Avx2Eight(unsafe {
                let indices = _mm256_srlv_epi32(_mm256_set1_epi32(lanes as i32), shifts);
                _mm256_permutevar8x32_ps(from.0, indices)
            })
        }
    }

    impl Eight for Avx2Eight {
        #[inline(always)]
        fn lesser(self, other: Self) -> Self {
            // SAFETY: an `Avx2Eight` exists only where there is AVX2, and the instruction touches no memory.
            Self(unsafe { _mm256_min_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn greater(self, other: Self) -> Self {
            // SAFETY: as in `lesser`.
            Self(unsafe { _mm256_max_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn lesser_bits(self, other: Self) -> Self {
            // SAFETY: as in `lesser`.
            Self(bytemuck::cast(unsafe { _mm256_min_epi32(self.bits(), other.bits()) }))
        }

        #[inline(always)]
        fn greater_bits(self, other: Self) -> Self {
            // SAFETY: as in `lesser`.
            Self(bytemuck::cast(unsafe { _mm256_max_epi32(self.bits(), other.bits()) }))
        }

        #[inline(always)]
        fn is_below_bits(self, other: Self) -> u32 {
            // SAFETY: as in `lesser`.
            unsafe {
                _mm256_movemask_ps(bytemuck::cast(_mm256_cmpgt_epi32(other.bits(), self.bits()))) as u32
            }
        }

        #[inline(always)]
        fn is_below(self, other: Self) -> u32 {
            // SAFETY: as in `lesser`.
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)) as u32 }
        }

        #[inline(always)]
        fn is_at_most(self, other: Self) -> u32 {
            // SAFETY: as in `lesser`.
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) as u32 }
        }

        #[inline(always)]
        fn to_array(self) -> [f32; LANES] {
            bytemuck::cast(self.0)
        }
    }

    macro_rules! vector_operator {
        ($($operator:ident $method:ident $instruction:ident),*) => {$(
            impl $operator for Avx2Eight {
                type Output = Self;

                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    // SAFETY: an `Avx2Eight` exists only where there is AVX2, and the instruction touches no memory.
                    Self(unsafe { $instruction(self.0, other.0) })
                }
            }
        )*};
    }

    vector_operator!(Add add _mm256_add_ps, Sub sub _mm256_sub_ps, Mul mul _mm256_mul_ps, Div div _mm256_div_ps);
}
