//! Membership functions without pieces that no value is on.

use fuzzypilot::fuzzy::system::Piece;

/// The same function, every value's degree the same, with as few pieces.
///
/// Of two pieces that begin at one place the later counts there, and the one before it counts nowhere; but left of the first
/// piece counts where that begins.
pub fn thinned(pieces: &[Piece]) -> Vec<Piece> {
    let mut kept: Vec<Piece> = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        let next = pieces.get(i + 1).filter(|next| next.from() == piece.from());
        match next {
            Some(next) if i > 0 || next.start() == piece.start() => {}
            _ => kept.push(*piece),
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::thinned;
    use fuzzypilot::fuzzy::system::shape::{singleton, trapezoid, triangle};

    #[test]
    fn a_trapezoid_without_a_roof_is_a_triangle() {
        let pieces = trapezoid(0, 10, 10, 30);
        assert_eq!(thinned(&pieces), triangle(0, 10, 30));
        assert_ne!(pieces[..], triangle(0, 10, 30));
    }

    #[test]
    fn a_step_stays() {
        assert_eq!(thinned(&singleton(5)), singleton(5));
        // Up at 0 and at once: left of it the degree is zero.
        assert_eq!(thinned(&trapezoid(0, 0, 10, 20)).len(), 4);
    }
}
