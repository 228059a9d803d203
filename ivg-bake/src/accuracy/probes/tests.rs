use super::{AXES, Axes, Probe, Probes, Stratum};

/// Ten vertices whose baked light is off by 2 W/m² along one axis, of which four have been gathered at, without noise; and two
/// that are off by 1 W/m², both gathered at.
fn probes() -> Probes {
    let far = Stratum { vertices: (10..20).collect(), gathered: 4, counts: true };
    let near = Stratum { vertices: vec![3, 4], gathered: 2, counts: true };
    let at = |vertex, stratum, off| {
        let mut axes = [0.0; AXES];
        axes[0] = off;
        Probe { vertex, stratum, axes, variance: 0.0, paths: 64 }
    };
    let far_probes = (10..14).map(|vertex| at(vertex, 0, 2.0));
    let probes = far_probes.chain([3, 4].map(|vertex| at(vertex, 1, 1.0))).collect();
    Probes { strata: vec![far, near], probes, paths: 6 * 64 }
}

fn squared(probes: &Probes) -> f64 {
    probes.bias(dark, |_| 0.0).squared
}

/// What photons brought: nothing.
fn dark(_: usize) -> Axes {
    Axes::default()
}

/// A stratum that is gathered in part keeps the bias of the rest: time may be up in the middle of it.
#[test]
fn vertices_that_are_not_gathered_keep_their_bias() {
    let all = 10.0 * 4.0 + 2.0 * 1.0;
    assert_eq!(squared(&probes()), all);
    for (done, left) in [(0, 10), (1, 9), (6, 4), (8, 2), (9, 1), (10, 0)] {
        let mut probes = probes();
        let worst = probes.worst(dark, |_| 0.0).unwrap();
        assert_eq!((worst.stratum, worst.squared, worst.vertices.len()), (0, 4.0, 10));
        assert!(
            worst.vertices[6..].iter().all(|vertex| (10..14).contains(vertex)),
            "the known ones come last"
        );
        probes.take(&worst, done);
        assert_eq!(squared(&probes), all - 4.0 * f64::from(10 - left), "{done} gathered");
        let known = probes.probes.iter().filter(|probe| probe.stratum == 0).count();
        if left > 0 {
            assert_eq!(known, 4.min(left as usize), "{done} gathered");
        } else {
            assert_eq!(
                probes.worst(dark, |_| 0.0).unwrap().stratum,
                1,
                "what is gathered is not gathered again"
            );
        }
        assert_eq!(probes.can_grow(), left > 4, "{done} gathered");
    }
}
