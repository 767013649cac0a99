// The page that `evodevo report --serve` serves, as a browser sees it.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/program.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
namespace http = boost::beast::http;
using namespace testing;
using ::testing::HasSubstr;

/// A run with a stand-in for the page of the viewer, and the program that serves it.
class Serve : public ::testing::Test {
 protected:
  Serve() {
    const fs::path program = EVODEVO_PROGRAM;
    for (const char* folder : {"bin", "share/evodevo/viewer"}) fs::create_directories(scratch_ / folder);
    fs::copy_file(program, program_);
    fs::create_symlink(program.parent_path().parent_path() / "lib", scratch_ / "lib");
    scratch_.write("share/evodevo/viewer/page.html",
                   "<meta content=\"default-src 'none'; img-src data:\"><body><script>EVODEVO_DATA</script></body>");
    run(run_, 12);
  }

  void run(const std::string& folder, int evaluations) {
    output_of({program_, "run", experiment_, "--no-report", "--out", folder, "--set",
               "experiment.evaluations=" + std::to_string(evaluations)});
  }

  /// Sends a request to the port of `address`. `host` is the name by which the page is addressed.
  static http::response<http::string_body> answer(const std::string& address, const std::string& path,
                                                  std::string host = "", http::verb method = http::verb::get) {
    const std::string place = address.substr(std::string("http://").size(), address.rfind('/') - 7);
    const auto port = static_cast<std::uint16_t>(std::stoi(place.substr(place.find(':') + 1)));
    boost::asio::io_context io;
    boost::beast::tcp_stream stream(io);
    stream.connect({boost::asio::ip::address_v4::loopback(), port});
    http::request<http::empty_body> request(method, path, 11);
    request.set(http::field::host, host.empty() ? place : host);
    http::write(stream, request);
    boost::beast::flat_buffer buffer;
    http::response<http::string_body> response;
    http::read(stream, buffer, response);
    return response;
  }

  Scratch scratch_;
  std::string program_ = (scratch_ / "bin/evodevo").string(), run_ = (scratch_ / "run").string();
  std::string experiment_ = scratch_.write("small.toml", small_experiment);
};

TEST_F(Serve, ThePageGrowsWithTheRunForPagesOfThisMachineAlone) {
  Process server({program_, "report", run_, "--serve", "0"});
  const std::string address = server.read_line().value();
  ASSERT_THAT(address, ::testing::MatchesRegex("http://127\\.0\\.0\\.1:[0-9]+/"));
  EXPECT_EQ(answer(address, "/generations").body(), "[2]");
  const auto page = answer(address, "/");
  EXPECT_EQ(page.result(), http::status::ok);
  EXPECT_THAT(page.body(), naming("\"kind\":\"report\"", "connect-src 'self'", "\"[2]\""));

  const std::string longer = (scratch_ / "longer").string();
  run(longer, 24);
  fs::rename(fs::path(longer) / "run.sqlite", fs::path(run_) / "run.sqlite");
  EXPECT_EQ(answer(address, "/generations").body(), "[4]");
  EXPECT_THAT(answer(address, "/").body(), HasSubstr("\"[4]\""));

  EXPECT_EQ(answer(address, "/", "elsewhere.example").result(), http::status::misdirected_request);
  EXPECT_EQ(answer(address, "/etc/passwd").result(), http::status::not_found);
  EXPECT_EQ(answer(address, "/", "", http::verb::post).result(), http::status::method_not_allowed);

  const std::string port = address.substr(address.rfind(':') + 1, address.rfind('/') - address.rfind(':') - 1);
  const auto refusal = [&](const Words& options) { return output_of(joined({program_, "report", run_}, options), 2); };
  EXPECT_THAT(refusal({"--serve", port}), naming("--serve " + port, "0"));
  EXPECT_THAT(refusal({"--serve", "65536"}), naming("--serve 65536", "0 to 65535"));
  EXPECT_THAT(refusal({"--serve", "0", "--out", "page.html"}), naming("--out page.html", "--serve"));

  server.send(SIGTERM);
  EXPECT_EQ(server.wait(), 0) << server.output();
  Process interrupted({program_, "report", run_, "--serve", "0"});
  ASSERT_TRUE(interrupted.read_line().has_value());
  interrupted.send(SIGINT);
  EXPECT_EQ(interrupted.wait(), 0) << interrupted.output();
}

TEST_F(Serve, ARunThatCannotBeReadEndsTheCommandAtOnce) {
  SQLite::Database(run_ + "/run.sqlite", SQLite::OPEN_READWRITE).exec("UPDATE scores SET value = 'many'");
  Process server({program_, "report", run_, "--serve", "0"});
  ASSERT_THAT(server.read_line().value_or(""), naming(run_, "score"));  // not an address
  EXPECT_EQ(server.wait(), 2) << server.output();
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
