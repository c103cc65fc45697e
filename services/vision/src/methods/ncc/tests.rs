use super::*;
use proptest::prelude::*;

const BOTH: [Colours; 2] = [Colours::Grey, Colours::Rgb];

fn noise(width: u32, height: u32, seed: u64) -> Frame {
    let mut state = seed | 1;
    let rgb = (0..3 * width * height).map(|_| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    });
    Frame::from_rgb(width, height, rgb.collect()).unwrap()
}

fn cut(frame: &Frame, RectPx { x, y, width, height }: RectPx) -> Frame {
    let rows = (y..y + height).flat_map(|row| &frame.row(row)[3 * x as usize..][..3 * width as usize]);
    Frame::from_rgb(width, height, rows.copied().collect()).unwrap()
}

/// Eq. 2.22 written out.
fn slowly(frame: &Frame, template: &Frame, colours: Colours, (x, y): (u32, u32)) -> f64 {
    let samples = |frame: &Frame, x: u32, y: u32| -> Vec<Vec<f64>> {
        let part = cut(frame, RectPx { x, y, width: template.width(), height: template.height() });
        let level = |pixel: &[u8; 3], channel: usize| match colours {
            Colours::Grey => super::super::plane::luma(*pixel),
            Colours::Rgb => pixel[channel],
        };
        let channel = |channel| {
            let levels: Vec<f64> =
                part.rgb().as_chunks::<3>().0.iter().map(|pixel| f64::from(level(pixel, channel))).collect();
            let mean = levels.iter().sum::<f64>() / levels.len() as f64;
            levels.iter().map(|level| level - mean).collect()
        };
        (0..colours.channels()).map(channel).collect()
    };
    let (f, h) = (samples(frame, x, y).concat(), samples(template, 0, 0).concat());
    let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let variance = sum(&f, &f);
    if variance <= windows::FLAT { 0.0 } else { sum(&f, &h) / (variance * sum(&h, &h)).sqrt() }
}

#[test]
fn the_best_window_is_where_the_template_was_cut() {
    let frame = noise(90, 70, 5);
    let window = RectPx { x: 41, y: 17, width: 13, height: 9 };
    for colours in BOTH {
        let options = NccOptions { colours, ..NccOptions::default() };
        let mut ncc = Ncc::new(&cut(&frame, window), &options).unwrap();
        for region in [None, Some(RectPx { x: 30, y: 10, width: 40, height: 40 }), Some(window)] {
            let found = ncc.search(&frame, region).unwrap();
            assert_eq!(found.window, window);
            assert_eq!(found.at, PointPx::new(47.5, 21.5));
            assert!(found.score > 0.999, "{found:?}");
        }
        assert_eq!(ncc.search(&frame, Some(RectPx { x: 41, y: 17, width: 12, height: 9 })), None);
        assert_eq!(ncc.search(&Frame::default(), None), None);
        assert_eq!(ncc.search(&frame, Some(RectPx { x: 90, y: 0, width: 9, height: 9 })), None);
    }
}

#[test]
fn a_larger_object_is_found_at_its_scale() {
    let blob = |x: f32, y: f32, cx: f32, cy: f32, r: f32| {
        (40.0 + 180.0 * (-((x - cx).powi(2) + 2.0 * (y - cy).powi(2)) / (r * r)).exp()) as u8
    };
    let drawn = |size: u32, cx: f32, cy: f32, r: f32| {
        let pixels =
            (0..size * size).map(|at| blob((at % size) as f32 + 0.5, (at / size) as f32 + 0.5, cx, cy, r));
        Frame::from_rgb(size, size, pixels.flat_map(|level| [level; 3]).collect()).unwrap()
    };
    let options = NccOptions { scales: vec![0.5, 1.0, 2.0], ..NccOptions::default() };
    let mut ncc = Ncc::new(&drawn(20, 10.0, 10.0, 5.0), &options).unwrap();
    for (scale, r) in [(0.5, 2.5), (1.0, 5.0), (2.0, 10.0)] {
        let found = ncc.search(&drawn(80, 37.0, 46.0, r), None).unwrap();
        assert_eq!(found.scale, scale, "{found:?}");
        assert!(found.at.distance_px(PointPx::new(37.0, 46.0)) < 1.0, "{found:?}");
    }
}

#[test]
fn templates_that_cannot_be_searched_are_refused() {
    let scales = |scales: &[f32]| NccOptions { scales: scales.to_vec(), ..NccOptions::default() };
    let any = noise(4, 4, 1);
    let flat = Frame::from_rgb(4, 4, vec![7; 48]).unwrap();
    assert_eq!(Ncc::new(&flat, &scales(&[1.0])).unwrap_err(), NccError::Flat { scale: 1.0 });
    assert_eq!(Ncc::new(&any, &scales(&[1.0, 0.1])).unwrap_err(), NccError::Empty { scale: 0.1 });
    assert_eq!(Ncc::new(&Frame::default(), &scales(&[1.0])).unwrap_err(), NccError::Empty { scale: 1.0 });
    for wrong in [&[][..], &[0.0], &[-1.0], &[f32::NAN], &[f32::INFINITY], &[1e9]] {
        assert!(matches!(Ncc::new(&any, &scales(wrong)), Err(NccError::Scale { .. })), "{wrong:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn scores_are_those_of_the_equation(
        seed in any::<u64>(), width in 1u32..40, height in 1u32..40,
        template_width in 1u32..12, template_height in 1u32..12, flat in any::<bool>(),
    ) {
        let mut frame = noise(width, height, seed);
        if flat {
            let half = frame.rgb().len() / 2;
            frame.rgb_mut()[half..].fill(200);
        }
        let template = noise(template_width, template_height, seed ^ 77);
        for colours in BOTH {
            let options = NccOptions { colours, ..NccOptions::default() };
            let Ok(mut ncc) = Ncc::new(&template, &options) else { continue };
            let surface = ncc.surface(&frame, None).clone();
            prop_assert_eq!(surface.is_empty(), template_width > width || template_height > height);
            for (x, y) in (0..surface.height()).flat_map(|y| (0..surface.width()).map(move |x| (x, y))) {
                let expected = slowly(&frame, &template, colours, (x, y));
                let score = f64::from(surface.get(x, y));
                prop_assert!((score - expected).abs() < 1e-3, "{} is not {} at ({}, {})", score, expected, x, y);
            }
        }
    }

    #[test]
    fn what_was_searched_before_leaves_no_trace(
        seed in any::<u64>(), regions in proptest::collection::vec((0u32..30, 0u32..20, 8u32..60, 8u32..50), 1..6),
    ) {
        let frame = noise(60, 50, seed);
        let options = NccOptions { scales: vec![0.8, 1.0, 1.5], ..NccOptions::default() };
        let template = noise(7, 6, seed ^ 5);
        let mut used = Ncc::new(&template, &options).unwrap();
        for (x, y, width, height) in regions {
            let region = Some(RectPx { x, y, width, height });
            let fresh = Ncc::new(&template, &options).unwrap().search(&frame, region);
            let again = used.search(&frame, region);
            prop_assert_eq!(again.is_some(), fresh.is_some());
            if let (Some(again), Some(fresh)) = (again, fresh) {
                // Transforms of another size round differently, which may decide between equals.
                prop_assert!((again.score - fresh.score).abs() < 1e-3, "{again:?} is not {fresh:?}");
            }
        }
    }
}
