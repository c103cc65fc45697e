//! A camera on a vehicle in a simulated world.

use vision::Frame;

use crate::camera::{Camera, Intrinsics};
use crate::drive::Wave;
use crate::options::{OptionsError, SceneOptions};
use crate::render::{Exposure, Film, MOMENTS, Renderer};
use crate::scene;
use crate::truth::{TrueObject, observe};
use crate::world::World;

/// One frame and what is really in it.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The picture.
    pub frame: Frame,
    /// Every named object of which a piece is visible.
    pub truth: Vec<TrueObject>,
    /// The middle of the exposure, nanoseconds after the middle of frame 0's.
    pub captured_offset_ns: i64,
}

/// A simulated camera: each frame depends on the options and its number only, so frames may be asked for in any
/// order and as often as wanted. After the end of the path the vehicle drives back to the start, and so on.
#[derive(Debug)]
pub struct Simulator {
    options: SceneOptions,
    intrinsics: Intrinsics,
    world: World,
    optics: Optics,
    renderer: Renderer,
}

/// How this camera sees light: its own white balance, and an exposure that swings.
#[derive(Clone, Debug)]
pub(crate) struct Optics {
    /// Part of the time between two frames during which the shutter is open.
    pub(crate) shutter: f64,
    /// Gain of R, G and B.
    pub(crate) balance: [f64; 3],
    /// Swing of the exposure over time, as a part of the gain.
    pub(crate) swing: Vec<Wave>,
    /// What a film does to its pictures.
    pub(crate) film: Option<Film>,
}

impl Simulator {
    /// Builds the world.
    ///
    /// # Errors
    /// When an option is outside its range.
    pub fn new(options: SceneOptions) -> Result<Self, OptionsError> {
        let options = options.validated()?;
        let (world, optics) = scene::build(&options);
        let camera_seed = options.seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ u64::from(options.vehicle);
        Ok(Self {
            options,
            intrinsics: Intrinsics::of_size(options.size),
            world,
            optics,
            renderer: Renderer::new(camera_seed),
        })
    }

    /// What this simulates.
    #[must_use]
    pub fn options(&self) -> &SceneOptions {
        &self.options
    }

    /// The camera's calibration.
    #[must_use]
    pub fn calibration(&self) -> Intrinsics {
        self.intrinsics
    }

    /// Renders frame `frame_index`, counted from 0.
    pub fn render(&mut self, frame_index: u64) -> Rendered {
        let time_s = frame_index as f64 / self.options.frame_rate_hz;
        let shutter_s = self.optics.shutter / self.options.frame_rate_hz;
        let middle = self.camera_at(time_s);
        let moments: [Camera; MOMENTS] = std::array::from_fn(|moment| {
            self.camera_at(time_s + shutter_s * ((moment as f64 + 0.5) / MOMENTS as f64 - 0.5))
        });
        let swing = 1.0 + crate::drive::sum(&self.optics.swing, time_s);
        let gain = self.optics.balance.map(|channel| channel * swing);
        let exposure =
            Exposure { middle: &middle, moments: &moments, gain, index: frame_index, film: self.optics.film };
        Rendered {
            frame: self.renderer.render(&self.world, exposure).into_frame(),
            truth: observe(&self.world, &middle),
            captured_offset_ns: (time_s * 1e9).round() as i64,
        }
    }

    fn camera_at(&self, time_s: f64) -> Camera {
        Camera::new(self.intrinsics, self.world.drive.pose_at(time_s))
    }
}
