//! How much what is found along a path counts.

use raywright_optics::Rgb;
use raywright_optics::spectra::Waves;

/// What a path carries for three wavelengths, all over the density with which the one that decides, the hero, has
/// drawn it so far: its own density there is 1, so that no mean of three is below a third.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weights {
    /// How much of the light from here gets back to where the path started.
    pub carried: Rgb,
    /// The density with which each would have drawn the path.
    pub drawn: Rgb,
    /// The same with light asked for where the path was scattered last, in place of the way that it has come since.
    pub asked: Rgb,
}

impl Weights {
    /// Of a path that starts.
    pub const START: Self = Self { carried: Rgb::ONE, drawn: Rgb::ONE, asked: Rgb::ONE };

    /// What light from here adds.
    #[inline]
    pub fn throughput(&self) -> Rgb {
        self.carried / self.drawn.mean()
    }

    /// Leaves the light of the first alone, the hero, which stands for all three: no other could have drawn what
    /// follows, and so its own density is all that the path so far counts over.
    pub fn end_all_but_hero(&mut self) {
        let (carried, asked) = (Waves::ended(self.carried), Rgb::splat(self.asked[0]));
        *self = Self { carried, drawn: Rgb::ONE, asked };
    }

    /// The same where any of the three decides, whichever is the hero at what parts them.
    pub fn end_all_but_first(&mut self) {
        *self = Self { carried: Waves::ended(self.throughput()), ..Self::START };
    }

    /// Multiplies all three.
    #[inline]
    pub fn times(&mut self, carried: Rgb, drawn: Rgb, asked: Rgb) {
        self.carried *= carried;
        self.drawn *= drawn;
        self.asked *= asked;
    }
}
