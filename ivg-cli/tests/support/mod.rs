//! A folder to work in, and the command run there.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

/// A room of 1 m with an open front and a light below its ceiling; metres.
pub(crate) const ROOM_OBJ: &str = "mtllib room.mtl
v 0 0 0
v 1 0 0
v 1 0 1
v 0 0 1
v 0 1 0
v 1 1 0
v 1 1 1
v 0 1 1
v 0.3 0.95 0.3
v 0.7 0.95 0.3
v 0.7 0.95 0.7
v 0.3 0.95 0.7
usemtl white
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
usemtl red
f 1 5 8 4
f 2 3 7 6
usemtl light
f 9 10 11 12
";

/// The materials of the room; the light radiates 10 W/(m² sr) downwards.
pub(crate) const ROOM_MTL: &str = "newmtl white
Kd 0.7 0.7 0.7
newmtl red
Kd 0.6 0.1 0.1
newmtl light
Kd 0 0 0
Ke 10 10 10
";

/// A folder that goes away with the test.
pub(crate) struct Workplace(tempfile::TempDir);

/// `ivg serve` in the background; stopped when dropped.
pub(crate) struct Server {
    child: Child,
    pub(crate) url: String,
}

impl Workplace {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    pub(crate) fn with_room() -> Self {
        let place = Self::new();
        place.write("room.obj", ROOM_OBJ.as_bytes());
        place.write("room.mtl", ROOM_MTL.as_bytes());
        place
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.file(name), bytes).expect("a writable folder");
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.file(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Runs the command to its end.
    pub(crate) fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().expect("the command starts")
    }

    /// Runs the command to its end with `input` on its stdin.
    pub(crate) fn run_with(&self, arguments: &[&str], input: &[u8]) -> Output {
        let mut command = self.command(arguments);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the command starts");
        // A command that refuses its arguments has gone before it reads.
        let _ = child.stdin.take().expect("a pipe").write_all(input);
        child.wait_with_output().expect("the command ends")
    }

    /// Runs the command to its end with its stdout at `stdout`.
    pub(crate) fn run_to(&self, arguments: &[&str], stdout: Stdio) -> Output {
        let mut command = self.command(arguments);
        command.stdout(stdout).stderr(Stdio::piped());
        command.spawn().and_then(Child::wait_with_output).expect("the command ends")
    }

    /// Runs the command, which must succeed; gives what it printed.
    pub(crate) fn ok(&self, arguments: &[&str]) -> Vec<u8> {
        let output = self.run(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        output.stdout
    }

    /// Serves a folder on a free port.
    pub(crate) fn serve(&self, directory: &str) -> Server {
        let mut child = self
            .command(&["serve", directory, "--listen", "127.0.0.1:0"])
            .stdout(Stdio::piped())
            .spawn()
            .expect("the command starts");
        let mut line = String::new();
        let stdout = child.stdout.take().expect("a pipe");
        BufReader::new(stdout).read_line(&mut line).expect("the first line");
        let url = line.split_whitespace().find(|word| word.starts_with("http://"));
        let url = url.unwrap_or_else(|| panic!("no address in {line:?}")).to_owned();
        Server { child, url }
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_ivg"));
        command.args(arguments).current_dir(self.path());
        command
    }

    fn file(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // A server that has ended already has failed its test.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Bytes as text.
pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
