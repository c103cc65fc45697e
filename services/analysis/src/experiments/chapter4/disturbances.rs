//! Chapter 5: which disturbance hurts most. The thesis names quantisation noise and blur from motion.

use simulator::SceneKind;
use vision::Frame;
use vision::frame::decode::{DecodeLimits, decode};
use vision::frame::encode::{Quality, encode_jpeg};

use crate::experiments::account::{Account, Thesis};
use crate::experiments::sampled::{STEP, score_sampled};
use crate::experiments::{ExperimentError, Lab};

/// What is done to each frame.
#[derive(Clone, Copy, Debug)]
enum Disturbance {
    /// Nothing.
    None,
    /// Levels rounded down to this many.
    Levels(u32),
    /// Compressed by JPEG of this quality.
    Jpeg(u8),
    /// Each pixel the mean of this many in its row: the camera turns while the shutter is open.
    MotionBlur(u32),
    /// Brighter or darker by this factor.
    Exposure(f32),
}

impl Disturbance {
    const ALL: [Self; 9] = [
        Self::None,
        Self::Levels(64),
        Self::Levels(16),
        Self::Jpeg(50),
        Self::Jpeg(15),
        Self::MotionBlur(5),
        Self::MotionBlur(11),
        Self::Exposure(0.9),
        Self::Exposure(1.1),
    ];

    fn name(self) -> String {
        match self {
            Self::None => "as simulated".to_owned(),
            Self::Levels(levels) => format!("{levels} levels a channel"),
            Self::Jpeg(quality) => format!("JPEG quality {quality}"),
            Self::MotionBlur(px) => format!("motion blur {px} px"),
            Self::Exposure(factor) => format!("exposure times {factor}"),
        }
    }

    fn applied(self, mut frame: Frame) -> Result<Frame, ExperimentError> {
        let each = |frame: &mut Frame, change: &dyn Fn(u8) -> u8| {
            frame.rgb_mut().iter_mut().for_each(|level| *level = change(*level))
        };
        match self {
            Self::None => {}
            Self::Levels(levels) => {
                let step = (256 / levels) as u8;
                each(&mut frame, &|level| level / step * step + step / 2);
            }
            Self::Exposure(factor) => {
                each(&mut frame, &|level| (f32::from(level) * factor).round().min(255.0) as u8)
            }
            Self::Jpeg(quality) => {
                let jpeg = encode_jpeg(&frame, Quality::new(quality).unwrap_or_default())?;
                frame = decode(&jpeg, &DecodeLimits::default())?;
            }
            Self::MotionBlur(px) => frame = blurred(&frame, px)?,
        }
        Ok(frame)
    }
}

fn blurred(frame: &Frame, px: u32) -> Result<Frame, ExperimentError> {
    let mut rgb = Vec::with_capacity(frame.rgb().len());
    for y in 0..frame.height() {
        let row = frame.row(y);
        for x in 0..frame.width() {
            let from = x.saturating_sub(px / 2);
            let to = (x + px / 2 + 1).min(frame.width());
            for channel in 0..3 {
                let sum: u32 = (from..to).map(|x| u32::from(row[3 * x as usize + channel])).sum();
                rgb.push((sum / (to - from)) as u8);
            }
        }
    }
    Ok(Frame::from_rgb(frame.width(), frame.height(), rgb)?)
}

/// The experiment.
pub(in crate::experiments) fn run(lab: &Lab) -> Result<Account, ExperimentError> {
    let drive = lab.drive(SceneKind::Rink)?;
    let landmark = lab.template(SceneKind::Rink, "red")?;
    let mut account = Account::default();
    let mut rates: Vec<(String, f64)> = Vec::new();
    for disturbance in Disturbance::ALL {
        let score = score_sampled(drive, landmark, |frame| disturbance.applied(frame))?;
        let name = disturbance.name();
        let thesis = match disturbance {
            Disturbance::Levels(_) | Disturbance::Jpeg(_) | Disturbance::MotionBlur(_) => {
                Thesis::Words("a major source of corrupt data")
            }
            Disturbance::None | Disturbance::Exposure(_) => Thesis::Silent,
        };
        account.compare(
            format!("red detection, {name}"),
            thesis,
            score.detection_rate,
            "of frames",
            format!("faithful, every {STEP}th frame"),
        );
        rates.push((name, score.detection_rate.unwrap_or(0.0)));
    }
    let (plain, disturbed) = (rates[0].1, &mut rates[1..]);
    disturbed.sort_by(|a, b| a.1.total_cmp(&b.1));
    let told: Vec<String> =
        disturbed.iter().take(3).map(|(name, rate)| format!("{name} ({:.0} %)", 100.0 * rate)).collect();
    account.sentence = format!(
        "Of the red block's {:.0} % detection the most is lost by {}.",
        100.0 * plain,
        told.join(", then ")
    );
    Ok(account)
}
