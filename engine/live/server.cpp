// SPDX-License-Identifier: Apache-2.0
#include "live/server.h"

#include <Poco/Net/HTTPRequestHandler.h>
#include <Poco/Net/HTTPRequestHandlerFactory.h>
#include <Poco/Net/HTTPServerConnection.h>
#include <Poco/Net/HTTPServerParams.h>
#include <Poco/Net/HTTPServerRequest.h>
#include <Poco/Net/HTTPServerResponse.h>
#include <Poco/Net/StreamSocket.h>
#include <Poco/Net/StreamSocketImpl.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <iostream>
#include <map>
#include <mutex>
#include <string_view>
#include <thread>

#include "live/campaign_service.h"
#include "live/guard.h"
#include "live/random_token.h"
#include "platform/process/channel.h"
#include "platform/storage/late_library.h"

namespace nonio::live {
namespace net = Poco::Net;

namespace {

/// Accepts connections on 127.0.0.1 and passes each on when the head of its request is complete, so
/// that a slow client occupies no thread.
class Front {
 public:
  static constexpr std::size_t most_waiting = 128;
  static constexpr std::chrono::seconds head_patience{5};

  static Expected<Front> open(std::uint16_t port);
  std::uint16_t port() const { return port_; }

  /// Passes each socket to `take` with its complete head still unread, or with the status of a
  /// rejection (400, 408, 414 or 431). Runs until `is_over`, which is called several times per
  /// second, returns true.
  void serve(const std::function<void(process::Handle, int refused)>& take,
             const std::function<bool()>& is_over);

 private:
  using Clock = std::chrono::steady_clock;
  Front(process::Handle socket, std::uint16_t port) : socket_(std::move(socket)), port_(port) {}
  void accept_all();
  /// Returns 200 for a complete head, the status of a rejection, 0 for an incomplete head, or -1
  /// for a closed connection.
  int look_at(int socket) const;

  struct Visitor {
    process::Handle socket;
    Clock::time_point since;
    std::size_t seen = 0;
  };
  process::Handle socket_;
  std::uint16_t port_;
  std::map<std::uint64_t, Visitor> waiting_{};
  std::uint64_t last_ = 0;
};

Expected<Front> Front::open(std::uint16_t port) {
  const auto failed = [&](const char* what) {
    return fail("127.0.0.1:" + std::to_string(port) + ": " + what + ": " + std::strerror(errno));
  };
  process::Handle socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket) return failed("socket");
  const int yes = 1;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  auto* const plain = reinterpret_cast<sockaddr*>(&address);
  if (::bind(socket.get(), plain, sizeof address) != 0) return failed("bind");
  if (::listen(socket.get(), SOMAXCONN) != 0) return failed("listen");
  socklen_t size = sizeof address;
  if (::getsockname(socket.get(), plain, &size) != 0) return failed("getsockname");
  return Front(std::move(socket), ntohs(address.sin_port));
}

void Front::accept_all() {
  while (true) {
    process::Handle visitor(
        ::accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!visitor) return;
    // The connection that has waited longest is closed.
    if (waiting_.size() == most_waiting) waiting_.erase(waiting_.begin());
    waiting_[++last_] = {std::move(visitor), Clock::now(), 0};
  }
}

int Front::look_at(int socket) const {
  constexpr std::size_t room = most_head + 4096;
  std::array<char, room> bytes;
  const ssize_t n = ::recv(socket, bytes.data(), bytes.size(), MSG_PEEK);
  if (n < 0) return errno == EAGAIN || errno == EINTR ? 0 : -1;
  if (n == 0) return -1;
  const std::string_view seen(bytes.data(), static_cast<std::size_t>(n));
  const std::size_t end = std::min(seen.find("\r\n\r\n"), seen.find("\n\n"));
  if (end != std::string_view::npos) return head_status(seen.substr(0, end));
  return seen.size() >= room ? 431 : 0;
}

void Front::serve(const std::function<void(process::Handle, int)>& take,
                  const std::function<bool()>& is_over) {
  constexpr int tick = 100, soon = 2;
  while (!is_over()) {
    std::vector<pollfd> all{{socket_.get(), POLLIN, 0}};
    for (const auto& [number, visitor] : waiting_) all.push_back({visitor.socket.get(), POLLIN, 0});
    // A socket with an incomplete head is always readable, so the loop pauses.
    if (::poll(all.data(), all.size(), tick) > 0 && all.front().revents == 0) ::usleep(soon * 1000);
    accept_all();
    std::vector<std::pair<std::uint64_t, int>> ready;
    for (const auto& [number, visitor] : waiting_) {
      const int state = look_at(visitor.socket.get());
      if (state != 0)
        ready.emplace_back(number, state);
      else if (Clock::now() - visitor.since > head_patience)
        ready.emplace_back(number, 408);
    }
    for (const auto& [number, state] : ready) {
      process::Handle socket = std::move(waiting_.at(number).socket);
      waiting_.erase(number);
      if (state > 0) take(std::move(socket), state == 200 ? 0 : state);
    }
  }
}

Expected<std::string> read_token(const std::string& file, int fd) {
  struct stat s {};
  if (::fstat(fd, &s) != 0) return fail(file + ": " + std::strerror(errno));
  if (!S_ISREG(s.st_mode) || s.st_uid != ::geteuid() || (s.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return fail(file + ": expected a file of this user that no other user can read (chmod 600)");
  std::array<char, token_digits + 2> bytes{};
  const ssize_t n = ::read(fd, bytes.data(), bytes.size());
  std::string token(bytes.data(), n > 0 ? static_cast<std::size_t>(n) : 0);
  if (token.ends_with('\n')) token.pop_back();
  if (token.size() != token_digits ||
      token.find_first_not_of("0123456789abcdef") != std::string::npos)
    return fail(file +
                ": expected a token of 32 hexadecimal digits (delete the file for a new one)");
  return token;
}

/// Creates the file with a new token if it does not exist, so that the address of the page remains
/// the same after a restart. An error unless only this user can read the file.
Expected<std::string> token_in(const std::string& file) {
  const process::Handle old(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (old) return read_token(file, old.get());
  if (errno != ENOENT) return fail(file + ": " + std::strerror(errno));
  auto token = random_token();
  if (!token) return token;
  const process::Handle made(
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
  const std::string line = *token + "\n";
  if (!made || ::write(made.get(), line.data(), line.size()) != static_cast<ssize_t>(line.size()))
    return fail(file + ": " + std::strerror(errno));
  return token;
}

constexpr std::size_t threads = 16, most_queued = 64;
constexpr auto heartbeat = std::chrono::seconds(15);
// Waiting events are sent at most 10 times per second.
constexpr auto between_events = std::chrono::milliseconds(100);
constexpr auto body_patience = std::chrono::seconds(30);

struct House {
  const Post& post;
  Service& service;
  std::atomic<bool> over = false;
};

Head head_of(const net::HTTPServerRequest& request) {
  Head head{request.getMethod(), request.getURI(), {}};
  for (const auto& [name, value] : request) head.fields.emplace_back(name, value);
  return head;
}

class Handler : public net::HTTPRequestHandler {
 public:
  explicit Handler(House& house) : house_(house) {}

  void handleRequest(net::HTTPServerRequest& request, net::HTTPServerResponse& response) override {
    const Head head = head_of(request);
    try {
      send(answer_to(head, request), response);
    } catch (const std::exception& e) {
      std::cerr << "nonio live: " << head.method << " "
                << head.target.substr(0, head.target.find('?')) << ": " << e.what() << "\n";
      if (!response.sent()) send(refused(500, "mistake"), response);
    }
  }

 private:
  Answer answer_to(const Head& head, net::HTTPServerRequest& request) {
    const Verdict verdict = judge(head, house_.post, house_.service.routes());
    if (verdict.status != 200) {
      Answer no;
      no.status = verdict.status;
      no.said = verdict.said;
      return no;
    }
    Request one{head, *verdict.route, verdict.names, ""};
    if (verdict.route->method == Method::post) {
      if (auto no = house_.service.before_body(head, *verdict.route)) return *std::move(no);
      const std::size_t most = verdict.route->most;
      if (!read_body(request.stream(), most, one.body))
        return refused(413, "body_or_slow", {{"most", std::to_string(most)}});
    }
    return house_.service.answer(one);
  }

  /// Returns false if the body is larger than `most` bytes or takes too long.
  static bool read_body(std::istream& from, std::size_t most, std::string& body) {
    const auto deadline = std::chrono::steady_clock::now() + body_patience;
    std::array<char, 1 << 14> part;
    // Only bytes that have arrived are read, so that a slow client does not block the thread after
    // the deadline.
    while (from.peek() != std::istream::traits_type::eof()) {
      const std::streamsize here = std::max<std::streamsize>(from.rdbuf()->in_avail(), 1);
      from.read(part.data(), std::min(here, static_cast<std::streamsize>(part.size())));
      body.append(part.data(), static_cast<std::size_t>(from.gcount()));
      if (body.size() > most || std::chrono::steady_clock::now() > deadline) return false;
    }
    return true;
  }

  void send(Answer plain, net::HTTPServerResponse& response) {
    const Answer answer = house_.service.sentences().spelled(std::move(plain));
    response.setStatus(static_cast<net::HTTPResponse::HTTPStatus>(answer.status));
    response.setReason(net::HTTPResponse::getReasonForStatus(response.getStatus()));
    response.setKeepAlive(false);
    for (const auto& [name, value] : security_headers()) response.set(name, value);
    for (const auto& [name, value] : answer.headers) response.set(name, value);
    if (answer.status == 405) response.set("Allow", "GET, POST");
    response.setContentType(answer.type);
    if (answer.stream) return stream(answer, response);
    response.setContentLength64(static_cast<Poco::Int64>(answer.body.size()));
    std::ostream& out = response.send();
    out << answer.body << std::flush;
  }

  /// Sends events until one side closes the connection or the session of the user ends.
  void stream(const Answer& answer, net::HTTPServerResponse& response) {
    response.setChunkedTransferEncoding(true);
    std::ostream& out = response.send();
    out << ":\n\n" << std::flush;
    auto last = std::chrono::steady_clock::now();
    while (out.good() && !answer.stream->closed() && !house_.over &&
           (!answer.may_go_on || answer.may_go_on())) {
      const auto events = answer.stream->wait(std::chrono::seconds(1));
      const auto now = std::chrono::steady_clock::now();
      if (events.empty() && now - last < heartbeat) continue;
      last = now;
      if (events.empty()) out << ":\n\n";
      for (const Event& event : events) out << event_text(event);
      out << std::flush;
      std::this_thread::sleep_for(between_events);
    }
    answer.events->leave(answer.stream);
  }

  House& house_;
};

class Handlers : public net::HTTPRequestHandlerFactory {
 public:
  explicit Handlers(House& house) : house_(house) {}
  net::HTTPRequestHandler* createRequestHandler(const net::HTTPServerRequest&) override {
    return new Handler(house_);
  }

 private:
  House& house_;
};

void set_timeout(int socket, int option, long seconds, long microseconds) {
  const timeval time{seconds, microseconds};
  ::setsockopt(socket, SOL_SOCKET, option, &time, sizeof time);
}

/// Reads the rest of the request, because otherwise the connection could be reset before the client
/// has read the answer. Ends after 64 reads or 0.2 s without data.
void part_from(int socket) {
  constexpr int most = 64;
  constexpr long soon = 200'000;  // time limit of one read, us
  ::shutdown(socket, SHUT_WR);
  set_timeout(socket, SO_RCVTIMEO, 0, soon);
  std::array<char, 1 << 16> rest;
  for (int i = 0; i<most&& ::recv(socket, rest.data(), rest.size(), 0)> 0; ++i)
    ;
}

/// Answers requests that were rejected because of their head.
void refuse(int socket, int status, const Sentences& sentences) {
  const Answer answer = sentences.spelled(
      status == 431
          ? refused(status, "head",
                    {{"fields", std::to_string(most_fields)}, {"bytes", std::to_string(most_head)}})
      : status == 414 ? refused(status, "target", {{"most", std::to_string(most_target)}})
                      : refused(status, status == 408 ? "slow" : "no_request"));
  std::string text =
      "HTTP/1.1 " + std::to_string(status) + " " +
      net::HTTPResponse::getReasonForStatus(static_cast<net::HTTPResponse::HTTPStatus>(status)) +
      "\r\nConnection: close\r\nContent-Type: application/json\r\nContent-Length: " +
      std::to_string(answer.body.size()) + "\r\n";
  for (const auto& [name, value] : security_headers()) text += name + ": " + value + "\r\n";
  text += "\r\n" + answer.body;
  set_timeout(socket, SO_SNDTIMEO, 1, 0);
  [[maybe_unused]] const ssize_t n = ::send(socket, text.data(), text.size(), MSG_NOSIGNAL);
}

class Pool {
 public:
  explicit Pool(House& house) : house_(house), params_(new net::HTTPServerParams) {
    params_->setKeepAlive(false);  // an idle connection must not occupy a thread
    params_->setTimeout(Poco::Timespan(5, 0));
    handlers_ = new Handlers(house);
    for (std::size_t i = 0; i < threads; ++i) all_.emplace_back([this] { work(); });
  }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;
  ~Pool() {
    house_.over = true;
    {
      const std::lock_guard lock(mutex_);
      for (const int fd : busy_) ::shutdown(fd, SHUT_RDWR);
    }
    arrived_.notify_all();
    for (std::thread& one : all_) one.join();
  }

  void take(process::Handle socket, int refused) {
    {
      const std::lock_guard lock(mutex_);
      if (queue_.size() >= most_queued) queue_.pop_front();
      queue_.emplace_back(std::move(socket), refused);
    }
    arrived_.notify_one();
  }

 private:
  void work() {
    while (true) {
      std::pair<process::Handle, int> next;
      {
        std::unique_lock lock(mutex_);
        arrived_.wait(lock, [&] { return house_.over || !queue_.empty(); });
        if (house_.over) return;
        next = std::move(queue_.front());
        queue_.pop_front();
        busy_.push_back(next.first.get());
      }
      const int fd = next.first.get();
      try {
        serve_one(next.first, next.second);
      } catch (const std::exception& e) {
        if (!house_.over) std::cerr << "nonio live: " << e.what() << "\n";
      }
      if (!house_.over) part_from(fd);
      const std::lock_guard lock(mutex_);
      std::erase(busy_, fd);
      next.first = process::Handle();
    }
  }

  void serve_one(const process::Handle& socket, int refused) {
    const int fd = socket.get();
    ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) & ~O_NONBLOCK);
    if (refused != 0) return refuse(fd, refused, house_.service.sentences());
    // Poco closes its descriptor while bytes are unread, so it gets a copy.
    const int copy = ::fcntl(fd, F_DUPFD_CLOEXEC, 0);
    if (copy < 0) return;
    try {
      net::HTTPServerConnection(net::StreamSocket(new Socket(copy)), params_, handlers_).run();
    } catch (const Poco::Exception&) {
      // Handlers catch their own exceptions, so the head was unreadable.
      if (!house_.over) refuse(fd, 400, house_.service.sentences());
    }
  }

  class Socket : public net::StreamSocketImpl {
   public:
    explicit Socket(int fd) : net::StreamSocketImpl(fd) {}
  };

  House& house_;
  net::HTTPServerParams::Ptr params_;
  net::HTTPRequestHandlerFactory::Ptr handlers_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<std::pair<process::Handle, int>> queue_;
  std::vector<int> busy_;
  std::vector<std::thread> all_;
};

/// Blocks the signals for which `serve_here` waits, and ignores SIGPIPE.
sigset_t block_signals() {
  sigset_t ends;
  ::sigemptyset(&ends);
  ::sigaddset(&ends, SIGINT);
  ::sigaddset(&ends, SIGTERM);
  ::sigaddset(&ends, SIGHUP);
  ::pthread_sigmask(SIG_BLOCK, &ends, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  return ends;
}

Expected<void> serve_here(const LiveWish& wish) {
  NONIO_TRY(auto front, Front::open(wish.port));
  auto service = service_of(wish);  // starts processes, so it must precede the first thread
  if (!service) return fail(service.error());
  std::string token;  // empty if users sign in
  if (!(*service)->signs_in()) {
    NONIO_TRY(auto made, wish.token_file.empty() ? random_token() : token_in(wish.token_file));
    token = std::move(made);
  }
  const sigset_t ends = block_signals();
  const Post post{front.port(), token, wish.hosts, false, wish.edit, (*service)->signs_in()};
  if (auto begun = (*service)->begin(); !begun) return fail(begun.error());
  House house{post, **service};
  {
    Pool pool(house);
    std::thread taker([&] {
      front.serve(
          [&](process::Handle socket, int refused) { pool.take(std::move(socket), refused); },
          [&] { return house.over.load(); });
    });
    std::cout << address_of(post) << (token.empty() ? "" : "#t=" + token) << std::endl;
    if (!wish.quiet)
      std::cerr << "nonio serve: open the address above in a browser on this computer"
                << (token.empty() ? "" : "; it contains the access token, so do not pass it on")
                << ". End with Ctrl-C.\n";
    int signal = 0;
    ::sigwait(&ends, &signal);
    house.over = true;
    (*service)->close();
    taker.join();
  }
  return {};
}

}  // namespace

}  // namespace nonio::live

NONIO_EXPORTED const nonio::live::Serve nonio_serve;
const nonio::live::Serve nonio_serve = nonio::live::serve_here;
