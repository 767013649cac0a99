// A web server that only this machine can reach.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace evodevo {

/// A document that the server sends.
struct Document {
  std::string type;  ///< media type, such as "text/html"
  std::string content;
};

/// Returns the document with a path, such as "/", or nullopt if there is none.
using Documents = std::function<std::optional<Document>(std::string_view path)>;

/// The port cannot be used, for the reason that what() gives.
struct PortError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Answers HTTP requests at a port of 127.0.0.1, one at a time, until this process gets SIGINT or SIGTERM. Port 0
/// stands for any free port. Calls `listening` with the address, such as "http://127.0.0.1:8080/", as soon as the
/// server can be reached. Throws PortError, and what `documents` throws. The library evodevo-serve exports this
/// function; it is loaded where somebody asks for a server, since it takes long to compile.
extern "C" void evodevo_serve_locally(std::uint16_t port,
                                      const std::function<void(const std::string& address)>& listening,
                                      const Documents& documents);

}  // namespace evodevo
