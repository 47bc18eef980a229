//! Things as numbers behind each other, from which devices read them.

use glam::Vec3;

/// A thing that is written as numbers in the order of its fields; in WGSL a function reads it, whose name ends with `_at`.
pub trait Words {
    /// Appends the numbers.
    fn write(&self, words: &mut Vec<f32>);

    /// The numbers.
    fn words(&self) -> Vec<f32> {
        let mut words = Vec::new();
        self.write(&mut words);
        words
    }
}

impl Words for f32 {
    fn write(&self, words: &mut Vec<f32>) {
        words.push(*self);
    }
}

impl Words for u32 {
    fn write(&self, words: &mut Vec<f32>) {
        words.push(*self as f32);
    }
}

impl Words for bool {
    fn write(&self, words: &mut Vec<f32>) {
        words.push(f32::from(u8::from(*self)));
    }
}

impl Words for Vec3 {
    fn write(&self, words: &mut Vec<f32>) {
        words.extend(self.to_array());
    }
}

/// Has a struct written as all of its fields in their order.
macro_rules! words {
    ($name:ident { $($field:ident),* }) => {
        impl $crate::words::Words for $name {
            fn write(&self, words: &mut Vec<f32>) {
                let Self { $($field),* } = self;
                $($crate::words::Words::write($field, words);)*
            }
        }
    };
}
pub(crate) use words;
