use super::*;

#[test]
fn grid_sizes() {
    assert_eq!("16x8x65535".parse(), Ok(GridSize([16, 8, 65535])));
    for wrong in ["", "16", "16x16", "16x16x0", "16x16x65536", "16x16x16x16", "16,16,16", "-1x2x3"] {
        assert!(wrong.parse::<GridSize>().is_err(), "{wrong}");
    }
}

#[test]
fn bounds() {
    let parsed: Bounds = "0,0,0,0.556,0.5488,-0.5592".parse().expect("six numbers");
    assert_eq!(parsed, Bounds(DVec3::ZERO, DVec3::new(0.556, 0.5488, -0.5592)));
    for wrong in ["", "1,2,3", "1,2,3,4,5,nan", "1,2,3,4,5,inf", "1,2,3,4,5,6,7", "a,b,c,d,e,f"] {
        assert!(wrong.parse::<Bounds>().is_err(), "{wrong}");
    }
}

#[test]
fn picture_sizes() {
    assert_eq!("640x480".parse(), Ok(PictureSize { width: 640, height: 480 }));
    for wrong in ["640", "0x1", "1x0", "16385x1", "axb", "1x2x3"] {
        assert!(wrong.parse::<PictureSize>().is_err(), "{wrong}");
    }
}

#[test]
fn schedules() {
    use ivg_stream::Schedule;
    assert_eq!("light".parse(), Ok(ScheduleArgument(Schedule::LightFirst)));
    assert_eq!("0.25".parse(), Ok(ScheduleArgument(Schedule::Proportion { light: 0.25 })));
    for wrong in ["", "0", "1", "nan", "heavy"] {
        assert!(wrong.parse::<ScheduleArgument>().is_err(), "{wrong}");
    }
}

#[test]
fn shares_and_factors() {
    assert!(share("0.5").is_ok() && share("1").is_err() && share("nan").is_err());
    assert!(share_or_all("1").is_ok() && share_or_all("0").is_ok() && share_or_all("1.1").is_err());
    assert!(positive("2").is_ok() && positive("0").is_err() && positive("inf").is_err());
}
