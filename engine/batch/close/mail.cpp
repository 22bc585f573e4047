// SPDX-License-Identifier: Apache-2.0
#include "batch/close/mail.h"

#include <Poco/Base64Encoder.h>
#include <Poco/Net/Context.h>
#include <Poco/Net/HTTPRequest.h>
#include <Poco/Net/HTTPResponse.h>
#include <Poco/Net/HTTPSClientSession.h>
#include <Poco/Net/MailMessage.h>
#include <Poco/Net/MailRecipient.h>
#include <Poco/Net/NetException.h>
#include <Poco/Net/RejectCertificateHandler.h>
#include <Poco/Net/SSLManager.h>
#include <Poco/Net/SecureSMTPClientSession.h>
#include <Poco/Net/SecureStreamSocket.h>
#include <Poco/Net/StringPartSource.h>
#include <Poco/URI.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <memory>
#include <sstream>
#include <utility>
#include <vector>

#include "campaign/config/site_files.h"
#include "platform/process/child.h"
#include "platform/storage/digest.h"
#include "platform/storage/late_library.h"

namespace nonio::batch {
namespace fs = std::filesystem;
namespace net = Poco::Net;

namespace {

constexpr std::size_t longest_answer = 300;  // longest quoted answer of a server or program, bytes
constexpr std::size_t longest_subject = 200;

/// Replaces control characters by spaces. A text longer than `longest` bytes is cut between
/// characters and gets "...".
std::string one_line(std::string text, std::size_t longest) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
  if (text.size() > longest) {
    std::size_t end = longest;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
    text = text.substr(0, end) + "...";
  }
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

/// Replaces a text that contains the secret, because a server may return what it received.
std::string without(const std::string& secret, const std::string& text) {
  if (secret.empty()) return text;
  const bool there = text.find(secret) != std::string::npos;
  return there ? "its answer contains a secret that was sent, and is not shown" : text;
}

/// Encodes a subject that is not ASCII as `=?UTF-8?B?...?=` words (RFC 2047), none of which splits
/// a character.
std::string encoded_subject(const std::string& subject) {
  const std::string text = one_line(subject, longest_subject);
  const bool plain = std::all_of(text.begin(), text.end(),
                                 [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  if (plain) return text;
  // 39 bytes are 52 characters in base64, so an encoded word has at most 75 characters.
  constexpr std::size_t piece = 39;
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = std::min(at + piece, text.size());
    while (end < text.size() && end > at + 1 &&
           (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U)
      --end;
    std::ostringstream base64;
    Poco::Base64Encoder(base64) << text.substr(at, end - at);
    (out += out.empty() ? "=?UTF-8?B?" : "\r\n =?UTF-8?B?") += base64.str();
    out += "?=";
    at = end;
  }
  return out;
}

void fill(net::MailMessage& message, const config::Mail& mail, const Letter& letter) {
  message.setSender(mail.from);
  for (const std::string& to : mail.to)
    message.addRecipient(net::MailRecipient(net::MailRecipient::PRIMARY_RECIPIENT, to));
  message.setSubject(encoded_subject(letter.subject));
  const std::string type = "text/plain; charset=UTF-8";
  if (letter.file.empty()) {
    message.setContentType(type);
    message.setContent(letter.text, net::MailMessage::ENCODING_BASE64);
  } else {  // the message deletes its parts
    message.addContent(new net::StringPartSource(letter.text, type),
                       net::MailMessage::ENCODING_BASE64);
    message.addAttachment(letter.file, new net::StringPartSource(
                                           letter.bytes, "application/octet-stream", letter.file));
  }
  message.set("Auto-Submitted", "auto-generated");  // RFC 3834: prevents automatic replies
  message.setDate(Poco::Timestamp());
}

/// Returns a descriptor of an anonymous file with `bytes`; -1 after an error.
int file_in_memory(const std::string& bytes) {
  const int file = ::memfd_create("mail", MFD_CLOEXEC);
  if (file < 0) return -1;
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(file, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno != EINTR) return ::close(file), -1;
    if (n > 0) done += static_cast<std::size_t>(n);
  }
  ::lseek(file, 0, SEEK_SET);
  return file;
}

std::string said_in(int file) {
  std::string said(4 * longest_answer, '\0');
  const ssize_t n = ::pread(file, said.data(), said.size(), 0);
  said.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  return one_line(std::move(said), longest_answer);
}

/// Returns the variables that the mail program receives; all others may contain passwords.
std::vector<std::string> kept_environment() {
  constexpr std::string_view kept[] = {"PATH=", "HOME=", "USER=", "LOGNAME=", "LANG=", "TZ="};
  std::vector<std::string> all = process::present_environment();
  std::erase_if(all, [&](const std::string& one) {
    return std::none_of(std::begin(kept), std::end(kept),
                        [&](std::string_view name) { return one.starts_with(name); });
  });
  return all;
}

Expected<std::string> by_program(const config::Mail& mail, const net::MailMessage& message,
                                 double seconds) {
  std::ostringstream text;
  message.write(text);
  std::string bytes = text.str();
  std::erase(bytes, '\r');  // a program on the same host expects line ends without CR
  const int input = file_in_memory(bytes), output = file_in_memory({});
  process::ChildEnd end;
  std::vector<std::string> command{mail.sendmail, "-i", "-f", mail.from, "--"};
  command.insert(command.end(), mail.to.begin(), mail.to.end());
  auto child =
      process::Child::start({std::move(command), kept_environment(), input, output, output});
  if (child.has_value()) end = child->wait(seconds);
  const std::string said = said_in(output);
  ::close(input);
  ::close(output);
  if (!child) return fail("cannot run " + mail.sendmail + ": " + child.error().message);
  if (!end.well)
    return fail(mail.sendmail + " refused the mail: " + end.words +
                (said.empty() ? "" : ": " + said));
  return std::string();
}

net::Context::Ptr context_of(const std::string& trust, const fs::path& site) {
  net::Context::Ptr context =
      new net::Context(net::Context::TLS_CLIENT_USE, trust.empty() ? "" : (site / trust),
                       net::Context::VERIFY_STRICT, 9, trust.empty());
  context->requireMinimumProtocol(net::Context::PROTO_TLSV1_2);
  context->enableExtendedCertificateVerification(true);  // also checks the name of the server
  net::SSLManager::instance().initializeClient(nullptr, new net::RejectCertificateHandler(false),
                                               context);
  return context;
}

void log_in(net::SMTPClientSession& session, const std::string& host, const config::Mail& mail,
            const std::string& password) {
  using Session = net::SMTPClientSession;
  try {
    session.login(host, Session::AUTH_PLAIN, mail.user, password);
  } catch (const net::SMTPException& e) {
    if (e.message().find("does not support") == std::string::npos) throw;
    session.login(host, Session::AUTH_LOGIN, mail.user, password);
  }
}

void converse(net::SecureSMTPClientSession& session, const config::Mail& mail,
              const net::Context::Ptr& context, const std::string& password,
              const net::MailMessage& message) {
  const std::string own = "localhost";  // the name of this host is not published
  session.open();
  session.login(own);
  if (mail.tls == config::Mail::Tls::starttls) {
    if (!session.startTLS(context)) throw net::SMTPException("the server does not take STARTTLS");
    session.login(own);
  }
  if (!mail.user.empty()) log_in(session, own, mail, password);
  session.sendMessage(message);
  session.close();
}

void talk(const config::Mail& mail, const fs::path& site, const std::string& password,
          const net::MailMessage& message, const Poco::Timespan& patience) {
  const auto port = static_cast<Poco::UInt16>(mail.port);
  net::Context::Ptr context;
  if (mail.tls != config::Mail::Tls::none) context = context_of(mail.trust, site);
  if (mail.tls == config::Mail::Tls::tls) {
    net::SecureStreamSocket socket(context);
    socket.setPeerHostName(mail.smtp);
    socket.connect(net::SocketAddress(mail.smtp, port), patience);
    net::SecureSMTPClientSession session(socket);
    session.setTimeout(patience);
    converse(session, mail, context, password, message);
  } else {
    net::SecureSMTPClientSession session(mail.smtp, port);
    session.setTimeout(patience);
    converse(session, mail, context, password, message);
  }
}

/// Ignores SIGPIPE, so that a connection closed by the server causes an error instead of ending the
/// process.
class WithoutPipeSignal {
 public:
  WithoutPipeSignal() : before_(::signal(SIGPIPE, SIG_IGN)) {}
  WithoutPipeSignal(const WithoutPipeSignal&) = delete;
  WithoutPipeSignal& operator=(const WithoutPipeSignal&) = delete;
  ~WithoutPipeSignal() { ::signal(SIGPIPE, before_); }

 private:
  sighandler_t before_;
};

Expected<std::string> by_server(const config::Mail& mail, const fs::path& site,
                                const net::MailMessage& message, double seconds) {
  std::string password;
  if (!mail.user.empty()) {
    NONIO_TRY(auto read,
              config::read_password({mail.password_file, mail.password_env,
                                     mail.password_credential, "the mail's password", "mail"},
                                    site));
    password = std::move(read);
  }
  const auto failed = [&](const std::string& why) {
    return fail(mail.smtp + ":" + std::to_string(mail.port) +
                " did not take the mail: " + one_line(without(password, why), longest_answer));
  };
  const WithoutPipeSignal hold;
  try {
    talk(mail, site, password, message, Poco::Timespan(static_cast<long>(seconds), 0));
  } catch (const Poco::Exception& e) {
    return failed(e.displayText());
  } catch (const std::exception& e) {
    return failed(e.what());
  }
  return std::string();
}

Expected<std::string> deliver(const config::Mail& mail, const fs::path& site, const Letter& letter,
                              double seconds) {
  net::MailMessage message;
  fill(message, mail, letter);
  return mail.smtp.empty() ? by_program(mail, message, seconds)
                           : by_server(mail, site, message, seconds);
}

Expected<std::string> post(const config::Webhook& webhook, const fs::path& site,
                           const std::string& body, double seconds) {
  const std::string none;
  NONIO_TRY(const auto secret,
            config::read_password(
                {webhook.secret_file, none, none, "the secret of the webhook", "webhook"}, site));
  if (secret.empty()) return fail("the secret of the webhook is empty");
  const WithoutPipeSignal hold;
  try {
    const Poco::URI address(webhook.url);
    const std::unique_ptr<net::HTTPClientSession> session =
        address.getScheme() == "https"
            ? std::make_unique<net::HTTPSClientSession>(address.getHost(), address.getPort(),
                                                        context_of(webhook.trust, site))
            : std::make_unique<net::HTTPClientSession>(address.getHost(), address.getPort());
    session->setTimeout(Poco::Timespan(static_cast<long>(seconds), 0));
    std::string target = address.getPathAndQuery();
    if (target.empty()) target = "/";
    net::HTTPRequest request(net::HTTPRequest::HTTP_POST, target, net::HTTPMessage::HTTP_1_1);
    request.setContentType("application/json");
    request.setContentLength64(static_cast<Poco::Int64>(body.size()));
    request.set("User-Agent", "nonio");
    request.set("X-Nonio-Signature", "sha256=" + storage::hmac_sha256(secret, body));
    session->sendRequest(request) << body << std::flush;
    net::HTTPResponse response;
    session->receiveResponse(response);
    if (response.getStatus() / 100 != 2)
      return fail(webhook.url + " answered " + std::to_string(response.getStatus()) + " " +
                  one_line(without(secret, response.getReason()), longest_answer));
  } catch (const Poco::Exception& e) {
    return fail(webhook.url + ": " + one_line(e.displayText(), longest_answer));
  } catch (const std::exception& e) {
    return fail(webhook.url + ": " + one_line(e.what(), longest_answer));
  }
  return std::string();
}

}  // namespace
}  // namespace nonio::batch

NONIO_EXPORTED const nonio::batch::PostTo nonio_post;
const nonio::batch::PostTo nonio_post = nonio::batch::post;
NONIO_EXPORTED const nonio::batch::Deliver nonio_deliver;
const nonio::batch::Deliver nonio_deliver = nonio::batch::deliver;
