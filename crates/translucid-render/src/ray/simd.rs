//! Vectors of eight `f32`: AVX2, or portable loops that give the same bits.

use std::ops::{Add, Div, Mul, Sub};

/// Lanes of a vector.
pub(super) const LANES: usize = 8;

/// A vector of eight `f32`; comparisons give a bit for each lane.
pub(super) trait F32x8:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The lesser number of each lane; the second one if either is NaN.
    fn lesser(self, other: Self) -> Self;
    /// The greater number of each lane; the second one if either is NaN.
    fn greater(self, other: Self) -> Self;
    /// The lesser number of each lane by its bits as a signed integer, which most processors find sooner: either one of two
    /// negative numbers (−0 counts as negative), else the lesser.
    fn lesser_bits(self, other: Self) -> Self;
    /// The greater number of each lane by its bits as a signed integer: either one of two negative numbers, else the greater.
    fn greater_bits(self, other: Self) -> Self;
    /// Lanes whose bits, as signed integers, are below the other's.
    fn is_below_bits(self, other: Self) -> u32;
    fn is_below(self, other: Self) -> u32;
    fn is_at_most(self, other: Self) -> u32;
    fn to_array(self) -> [f32; LANES];
}

/// A token that makes vectors of one kind: having it proves that the processor has their instructions.
pub(super) trait SimdToken: Copy {
    type F32x8: F32x8;

    fn splat(self, number: f32) -> Self::F32x8;
    fn load(self, numbers: &[f32; LANES]) -> Self::F32x8;
    /// Permutes lanes: each takes the number of the lane given by its three bits of `lanes`, the first lane's lowest.
    fn pick(self, from: Self::F32x8, lanes: u32) -> Self::F32x8;
}

/// The token of portable loops over lanes.
#[derive(Clone, Copy)]
pub(super) struct Portable;

#[derive(Clone, Copy)]
pub(super) struct PortableF32x8([f32; LANES]);

impl PortableF32x8 {
    #[inline(always)]
    fn with(self, other: Self, of_lane: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|lane| of_lane(self.0[lane], other.0[lane])))
    }

    #[inline(always)]
    fn bits(self, other: Self, of_lane: impl Fn(f32, f32) -> bool) -> u32 {
        (0..LANES).fold(0, |bits, lane| bits | u32::from(of_lane(self.0[lane], other.0[lane])) << lane)
    }
}

impl SimdToken for Portable {
    type F32x8 = PortableF32x8;

    #[inline(always)]
    fn splat(self, number: f32) -> PortableF32x8 {
        PortableF32x8([number; LANES])
    }

    #[inline(always)]
    fn load(self, numbers: &[f32; LANES]) -> PortableF32x8 {
        PortableF32x8(*numbers)
    }

    #[inline(always)]
    fn pick(self, from: PortableF32x8, lanes: u32) -> PortableF32x8 {
        PortableF32x8(std::array::from_fn(|lane| from.0[(lanes >> (3 * lane)) as usize % LANES]))
    }
}

impl F32x8 for PortableF32x8 {
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
        impl $operator for PortableF32x8 {
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

/// Vectors of AVX2.
///
/// No function here has a `target_feature`, as it could then not be `inline(always)`: calls cost a fifth of all rays per
/// second.
#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::{
        __m256, __m256i, _CMP_LE_OQ, _CMP_LT_OQ, _mm256_add_ps, _mm256_cmp_ps, _mm256_cmpgt_epi32,
        _mm256_div_ps, _mm256_max_epi32, _mm256_max_ps, _mm256_min_epi32, _mm256_min_ps, _mm256_movemask_ps,
        _mm256_mul_ps, _mm256_permutevar8x32_ps, _mm256_set1_epi32, _mm256_set1_ps, _mm256_srlv_epi32,
        _mm256_sub_ps,
    };

    use super::{Add, Div, F32x8, LANES, Mul, SimdToken, Sub};

    /// The token of vectors of AVX2.
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
    pub(in crate::ray) struct Avx2F32x8(__m256);

    impl Avx2F32x8 {
        #[inline(always)]
        fn bits(self) -> __m256i {
            bytemuck::cast(self.0)
        }
    }

    impl SimdToken for Avx2 {
        type F32x8 = Avx2F32x8;

        #[inline(always)]
        fn splat(self, number: f32) -> Avx2F32x8 {
            // SAFETY: an `Avx2` exists only where there is AVX2, and the instructions touch no memory.
            Avx2F32x8(unsafe { _mm256_set1_ps(number) })
        }

        #[inline(always)]
        fn load(self, numbers: &[f32; LANES]) -> Avx2F32x8 {
            Avx2F32x8(bytemuck::cast(*numbers))
        }

        #[inline(always)]
        fn pick(self, from: Avx2F32x8, lanes: u32) -> Avx2F32x8 {
            let shifts = bytemuck::cast([0_i32, 3, 6, 9, 12, 15, 18, 21]);
            // SAFETY: as in `splat`; of each index the instruction takes the lowest three bits.
            Avx2F32x8(unsafe {
                let indices = _mm256_srlv_epi32(_mm256_set1_epi32(lanes as i32), shifts);
                _mm256_permutevar8x32_ps(from.0, indices)
            })
        }
    }

    impl F32x8 for Avx2F32x8 {
        #[inline(always)]
        fn lesser(self, other: Self) -> Self {
            // SAFETY: an `Avx2F32x8` exists only where there is AVX2, and the instruction touches no memory.
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
            impl $operator for Avx2F32x8 {
                type Output = Self;

                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    // SAFETY: an `Avx2F32x8` exists only where there is AVX2, and the instruction touches no memory.
                    Self(unsafe { $instruction(self.0, other.0) })
                }
            }
        )*};
    }

    vector_operator!(Add add _mm256_add_ps, Sub sub _mm256_sub_ps, Mul mul _mm256_mul_ps, Div div _mm256_div_ps);
}
