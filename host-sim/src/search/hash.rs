//! Fingerprints of what a search depends on.

/// A running 64-bit FNV-1a hash: the same on every machine and in every version, as files need it. Not against malice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hash(u64);

impl Default for Hash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Hash {
    /// With more bytes.
    pub fn and(self, bytes: &[u8]) -> Self {
        let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
        Self(bytes.iter().fold(self.0, step))
    }

    /// Of a vector's exact bits.
    pub fn of_vector(vector: &[f64]) -> Self {
        vector.iter().fold(Self::default(), |hash, x| {
            hash.and(&x.to_bits().to_le_bytes())
        })
    }

    /// As a number.
    pub fn bits(self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_published_function() {
        assert_eq!(Hash::default().and(b"a").bits(), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(Hash::default().and(b"foobar").bits(), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn every_bit_of_a_vector_counts() {
        let of = |vector: &[f64]| Hash::of_vector(vector);
        assert_ne!(of(&[0.0]), of(&[-0.0]));
        assert_ne!(of(&[1.0, 2.0]), of(&[2.0, 1.0]));
    }
}
