// A web server that only this machine can reach.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
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

/// Answers HTTP requests at a port of 127.0.0.1, one at a time, until this process gets SIGINT or SIGTERM. Port 0
/// stands for any free port. Calls `listening` with the address, such as "http://127.0.0.1:8080/", as soon as the
/// server can be reached. Throws InputError if the port cannot be used, and what `documents` throws.
void serve_locally(std::uint16_t port, const std::function<void(const std::string& address)>& listening,
                   const Documents& documents);

}  // namespace evodevo
