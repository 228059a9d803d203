//! Where a scene directory is: the one kind of URL the client reads.

use std::fmt;
use std::str::FromStr;

use hyper::Uri;

/// A scene directory on an HTTP server: `http://HOST[:PORT]/PATH/`, or with `scene.glb` at its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct SceneUrl {
    /// Host as in the URL, with brackets where it is an IPv6 address.
    host: String,
    port: u16,
    /// Path of the directory, with a slash at both ends.
    directory: String,
    /// Query that is sent along with every request, with its question mark; or empty.
    query: String,
}

/// Why a text is no URL of a scene directory.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{url}: {reason}; expected http://HOST[:PORT]/PATH/ of a scene directory")]
pub struct UrlError {
    url: String,
    reason: &'static str,
}

/// The file that describes a scene directory.
pub(crate) const SCENE_FILE: &str = "scene.glb";

impl FromStr for SceneUrl {
    type Err = UrlError;

    fn from_str(text: &str) -> Result<Self, UrlError> {
        let wrong = |reason| UrlError { url: text.to_owned(), reason };
        let uri: Uri = text.parse().map_err(|_| wrong("not a URL"))?;
        match uri.scheme_str() {
            Some("http") => {}
            Some("https") => {
                return Err(wrong("this client does not speak https; put a proxy in front of it"));
            }
            _ => return Err(wrong("only http is spoken")),
        }
        let authority = uri.authority().ok_or_else(|| wrong("no host"))?;
        if authority.as_str().contains('@') {
            return Err(wrong("a user name or password in a URL is not sent"));
        }
        if authority.host().is_empty() {
            return Err(wrong("no host"));
        }
        let path = uri.path();
        let directory = match path.strip_suffix(SCENE_FILE) {
            Some(directory) if directory.ends_with('/') => directory.to_owned(),
            _ if path.ends_with('/') => path.to_owned(),
            _ => format!("{path}/"),
        };
        Ok(Self {
            host: authority.host().to_owned(),
            port: uri.port_u16().unwrap_or(80),
            directory,
            query: uri.query().map(|query| format!("?{query}")).unwrap_or_default(),
        })
    }
}

impl SceneUrl {
    /// Host and port as `TcpStream::connect` takes them.
    pub(super) fn address(&self) -> (String, u16) {
        (self.host.trim_start_matches('[').trim_end_matches(']').to_owned(), self.port)
    }

    /// The value of the `Host` field.
    pub(super) fn host_field(&self) -> String {
        if self.port == 80 { self.host.clone() } else { format!("{}:{}", self.host, self.port) }
    }

    /// What is asked for to get the file `name` of the directory, a safe relative URI.
    pub(super) fn target(&self, name: &str) -> String {
        format!("{}{name}{}", self.directory, self.query)
    }
}

impl fmt::Display for SceneUrl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "http://{}{}{}", self.host_field(), self.directory, self.query)
    }
}

#[cfg(test)]
mod tests;
