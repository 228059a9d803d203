use std::process::ExitCode;

use ivg_stream::ServerOptions;

use crate::args::ServeArguments;
use crate::failure::Failure;
use crate::files;

pub(crate) fn run(arguments: &ServeArguments) -> Result<ExitCode, Failure> {
    let options = ServerOptions { address: arguments.listen, ..ServerOptions::default() };
    let directory = &arguments.directory;
    ivg_stream::serve_blocking(directory, &options, |address| {
        let line = format!("serving {} on http://{address}/ until Ctrl-C\n", directory.display());
        // Who does not see the line may still be served.
        if let Err(failure) = files::print(&line) {
            eprintln!("ivg: warning: {failure}");
        }
    })
    .map_err(|error| Failure::file(directory, error))?;
    Ok(ExitCode::SUCCESS)
}
