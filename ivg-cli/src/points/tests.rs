use super::*;

fn refused(text: &str, parts: &[&str]) {
    let message = Points::parse(text.as_bytes()).unwrap_err();
    assert!(parts.iter().all(|part| message.contains(part)), "{text:?}: {message}");
}

#[test]
fn columns_come_in_any_order_and_others_are_kept() {
    let text = "\u{feff}name,nz,ny,nx,z,y,x\n\"a, b\", 0,-2,0 ,3,2e0,1\nc,1e-300,0,0,-0.5,0,7\n";
    let points = Points::parse(text.as_bytes()).unwrap();
    let found: Vec<Point> = points.iter().collect();
    assert_eq!(found[0], Point { position: DVec3::new(1.0, 2.0, 3.0), normal: Vec3::NEG_Y });
    assert_eq!(found[1], Point { position: DVec3::new(7.0, 0.0, -0.5), normal: Vec3::Z });
    let out = points.with_results(&[Vec3::new(0.5, 1.0, 2.0), Vec3::ZERO]).unwrap();
    let expected =
        "name,nz,ny,nx,z,y,x,r,g,b\n\"a, b\",0,-2,0,3,2e0,1,0.5,1,2\nc,1e-300,0,0,-0.5,0,7,0,0,0\n";
    assert_eq!(String::from_utf8(out).unwrap(), expected);
}

#[test]
fn what_is_wrong_is_named_by_line_and_column() {
    refused("", &["line 1", "x,y,z,nx,ny,nz are missing"]);
    refused("x,y,z,nx,nz\n", &["line 1", "ny is missing"]);
    refused("x,y,z,nx,ny,nz,x\n", &["line 1", "two columns x"]);
    refused("x,y,z,nx,ny,nz,g\n", &["line 1", "column g"]);
    let header = "x,y,z,nx,ny,nz";
    refused(&format!("{header}\n0,0,0,0,1,0\n0,one,0,0,1,0\n"), &["line 3", "column y", "'one'"]);
    refused(&format!("{header}\n0,0,0,0,inf,0\n"), &["line 2", "column ny", "'inf'"]);
    refused(&format!("{header}\n0,0,0,0,-0,0\n"), &["line 2", "nx,ny,nz", "zero"]);
    refused(&format!("{header}\n0,0,0,0,1\n"), &["line 2: 5 columns, the header has 6"]);
    let message = Points::parse(b"x,y,z,nx,ny,nz\n1,1,1,0,1,0\n\xff,1,1,0,1,0\n").unwrap_err();
    assert_eq!(message, "line 3: this is not UTF-8 text");
}

#[test]
fn lines_are_counted_as_an_editor_does() {
    let (header, good, bad, short) = ("x,y,z,nx,ny,nz", "1,1,1,0,1,0", "q,1,1,0,1,0", "1,1,1,0,1");
    for end in ["\n", "\r\n", "\r"] {
        for last in [end, ""] {
            for (row, what) in [(bad, "line 3, column x"), (short, "line 3: 5 columns")] {
                refused(&format!("{header}{end}{good}{end}{row}{last}"), &[what]);
            }
            refused(
                &format!("{end}{header}{end}{end}{end}{good}{end}{end}{bad}{last}"),
                &["line 7, column x"],
            );
        }
        refused(&format!("{end}{end}x,y{end}"), &["line 3: the header"]);
        // A cell in quotes may hold line ends.
        refused(&format!("{header},name{end}{good},\"a{end}b\"{end}{bad},c{end}"), &["line 4, column x"]);
    }
}
