#include "report/server/local_server.hpp"

// clang-format off
#include <utility>  // comes first because Asio of Boost 1.74 uses std::exchange without it
// clang-format on

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <csignal>
#include <exception>

namespace evodevo {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;
using Request = http::request<http::empty_body>;
using Response = http::response<http::string_body>;

constexpr std::chrono::seconds longest_silence{60};  ///< after which a connection is closed

/// Returns an acceptor that listens at a port of this machine.
tcp::acceptor listening_at(asio::io_context& io, std::uint16_t port) {
  const tcp::endpoint place(asio::ip::address_v4::loopback(), port);
  try {
    return {io, place};
  } catch (const boost::system::system_error& error) {
    throw PortError(error.code().message());
  }
}

class Server {
 public:
  Server(asio::io_context& io, std::uint16_t port, const Documents& documents)
      : acceptor_(listening_at(io, port)),
        host_("127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port())),
        documents_(documents) {}

  /// The address without "http://".
  const std::string& host() const { return host_; }

  /// Accepts connections without end.
  asio::awaitable<void> accept() {
    for (;;) {
      tcp::socket socket = co_await acceptor_.async_accept(asio::use_awaitable);
      asio::co_spawn(acceptor_.get_executor(), converse(std::move(socket)), rethrow);
    }
  }

  /// Lets an error of a coroutine end the server.
  static void rethrow(const std::exception_ptr& error) {
    if (error) std::rethrow_exception(error);
  }

 private:
  /// Answers the requests that come through a connection, until the other side ends it.
  asio::awaitable<void> converse(tcp::socket socket) {
    boost::beast::tcp_stream stream(std::move(socket));
    boost::beast::flat_buffer buffer;
    for (error_code error; !error;) {
      Request request;
      stream.expires_after(longest_silence);
      co_await http::async_read(stream, buffer, request, asio::redirect_error(asio::use_awaitable, error));
      if (error) co_return;
      const Response response = response_to(request);
      stream.expires_after(longest_silence);
      co_await http::async_write(stream, response, asio::redirect_error(asio::use_awaitable, error));
      if (response.need_eof()) co_return;
    }
  }

  Response response_to(const Request& request) const {
    Response response(http::status::ok, request.version());
    response.keep_alive(request.keep_alive());
    response.set(http::field::cache_control, "no-store");
    // a page from elsewhere whose name leads to this machine must not read the run
    if (request[http::field::host] != host_)
      response.result(http::status::misdirected_request);
    else if (request.method() != http::verb::get)
      response.result(http::status::method_not_allowed);
    else if (std::optional<Document> document = documents_({request.target().data(), request.target().size()})) {
      response.set(http::field::content_type, document->type);
      response.body() = std::move(document->content);
    } else {
      response.result(http::status::not_found);
    }
    response.prepare_payload();
    return response;
  }

  tcp::acceptor acceptor_;
  std::string host_;
  const Documents& documents_;
};

}  // namespace

extern "C" __attribute__((visibility("default"))) void evodevo_serve_locally(
    std::uint16_t port, const std::function<void(const std::string& address)>& listening, const Documents& documents) {
  asio::io_context io;
  Server server(io, port, documents);
  asio::signal_set signals(io, SIGINT, SIGTERM);
  signals.async_wait([&](const error_code&, int) { io.stop(); });
  asio::co_spawn(io, server.accept(), Server::rethrow);
  listening("http://" + server.host() + "/");
  io.run();
}

}  // namespace evodevo
