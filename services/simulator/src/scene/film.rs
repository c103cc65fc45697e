//! What makes a scene look like a film from a moving car: its camera is worse, and the stop sign's street redder.

use super::{Dice, stop_sign};
use crate::options::{SceneKind, SceneOptions};
use crate::render::Film;
use crate::simulator::Optics;
use crate::world::World;

/// Choices of films come from streams of their own, so that the world is the clean one's.
const FILM_STREAM: u64 = 1_000_000;
/// The lens's blur is given for pictures of this width, px.
const USUAL_WIDTH_PX: f64 = 640.0;

/// The same world and camera, filmed.
pub(super) fn shot(options: &SceneOptions, mut world: World, mut optics: Optics) -> (World, Optics) {
    let dice = &mut Dice::new(options.seed, FILM_STREAM + u64::from(options.vehicle));
    optics.shutter = dice.within(0.5, 0.9);
    // Automatic exposure hunts slowly, and more than a good camera's.
    optics.swing.push(dice.wave(0.06..0.14, 0.05..0.15));
    optics.film = Some(Film {
        lens_sigma_px: dice.within(0.45, 1.0) * f64::from(options.size.width) / USUAL_WIDTH_PX,
        grain_q2: dice.one_of(&[5, 6, 8, 10]),
        sharpening: dice.within(0.0, 0.5) as f32,
        jpeg_quality: dice.within(70.0, 85.0).round() as u8,
    });
    if options.kind == SceneKind::StopSign {
        world.items.extend(stop_sign::street(&mut Dice::new(options.seed, FILM_STREAM / 2)));
    }
    (world, optics)
}
