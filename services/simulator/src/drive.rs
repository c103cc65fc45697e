//! Where a vehicle is at a given time: forth along its path, then back, without end.

use crate::camera::Pose;
use crate::vector::Vec3;

/// One sine of a sum: `amplitude · sin(2π · rate · t + phase)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wave {
    pub(crate) amplitude: f64,
    /// Cycles per second, or per metre where the argument is a distance.
    pub(crate) rate: f64,
    pub(crate) phase_rad: f64,
}

/// The value of a sum of waves.
pub(crate) fn sum(waves: &[Wave], at: f64) -> f64 {
    waves
        .iter()
        .map(|wave| wave.amplitude * (std::f64::consts::TAU * wave.rate * at + wave.phase_rad).sin())
        .sum()
}

/// A drive straight ahead along x, with sway, bumps and vibration.
#[derive(Clone, Debug)]
pub(crate) struct Drive {
    /// Length of the path, metres.
    pub(crate) length_m: f64,
    /// Time for one way, seconds.
    pub(crate) one_way_s: f64,
    /// Time by which this vehicle is ahead, seconds.
    pub(crate) head_start_s: f64,
    /// Distance of the path from the x axis, metres, positive to the left.
    pub(crate) offset_m: f64,
    /// Height of the camera above the ground, metres.
    pub(crate) camera_height_m: f64,
    /// Fixed pitch of the camera, positive down.
    pub(crate) camera_pitch_rad: f64,
    /// Sway of the path over distance, metres.
    pub(crate) sway_m: Vec<Wave>,
    /// Bumps over time, metres.
    pub(crate) height_m: Vec<Wave>,
    /// Vibration over time, radians.
    pub(crate) yaw_rad: Vec<Wave>,
    /// Vibration over time, radians.
    pub(crate) pitch_rad: Vec<Wave>,
    /// Vibration over time, radians.
    pub(crate) roll_rad: Vec<Wave>,
}

/// Part of one way during which the vehicle gains speed, and likewise loses it.
const RAMP: f64 = 0.08;

/// Distance covered, 0..1, when `time` (0..1) of one way has passed: constant speed between two even ramps.
fn progress(time: f64) -> f64 {
    let covered = if time < RAMP {
        time * time / (2.0 * RAMP)
    } else if time > 1.0 - RAMP {
        1.0 - RAMP - (1.0 - time).powi(2) / (2.0 * RAMP)
    } else {
        time - RAMP / 2.0
    };
    covered / (1.0 - RAMP)
}

impl Drive {
    /// The camera's pose `time_s` after the start.
    pub(crate) fn pose_at(&self, time_s: f64) -> Pose {
        let ways = ((time_s + self.head_start_s) / self.one_way_s).rem_euclid(2.0);
        let x = self.length_m * progress(if ways < 1.0 { ways } else { 2.0 - ways });
        let slope = (sum(&self.sway_m, x + 1e-4) - sum(&self.sway_m, x - 1e-4)) / 2e-4;
        Pose {
            position: Vec3::new(
                x,
                self.offset_m + sum(&self.sway_m, x),
                self.camera_height_m + sum(&self.height_m, time_s),
            ),
            yaw_rad: slope.atan() + sum(&self.yaw_rad, time_s),
            pitch_rad: self.camera_pitch_rad + sum(&self.pitch_rad, time_s),
            roll_rad: sum(&self.roll_rad, time_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_way_covers_the_path_at_an_even_speed() {
        assert_eq!((progress(0.0), progress(1.0)), (0.0, 1.0));
        let steps: Vec<f64> = (0..=1000).map(|i| progress(f64::from(i) / 1000.0)).collect();
        let largest = steps.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        assert!(steps.is_sorted() && largest < 1.0 / 1000.0 / (1.0 - RAMP) + 1e-9);
    }
}
