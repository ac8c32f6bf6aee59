// SPDX-License-Identifier: Apache-2.0
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>
#include <openssl/x509v3.h>

#include <filesystem>

#include "echo_server.h"

namespace fourdvt::live {
namespace {

// Writes a key and a self-signed certificate. names: as in subjectAltName.
void writeCertificate(const std::string& certificate_file, const std::string& key_file, const char* names) {
  EVP_PKEY* key = EVP_EC_gen("P-256");
  X509* certificate = X509_new();
  X509_set_version(certificate, 2);
  ASN1_INTEGER_set(X509_get_serialNumber(certificate), 1);
  X509_gmtime_adj(X509_getm_notBefore(certificate), -3600);
  X509_gmtime_adj(X509_getm_notAfter(certificate), 3600);
  X509_set_pubkey(certificate, key);
  X509_NAME* name = X509_get_subject_name(certificate);
  X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC, reinterpret_cast<const unsigned char*>("live"), -1, -1, 0);
  X509_set_issuer_name(certificate, name);
  X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, nullptr, NID_subject_alt_name, names);
  X509_add_ext(certificate, extension, -1);
  X509_EXTENSION_free(extension);
  X509_sign(certificate, key, EVP_sha256());
  std::FILE* file = std::fopen(certificate_file.c_str(), "wb");
  PEM_write_X509(file, certificate);
  std::fclose(file);
  file = std::fopen(key_file.c_str(), "wb");
  PEM_write_PrivateKey(file, key, nullptr, nullptr, 0, nullptr, nullptr);
  std::fclose(file);
  X509_free(certificate);
  EVP_PKEY_free(key);
}

class Tls : public EchoServer {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "live_net_tls";
    std::filesystem::create_directories(folder_);
    writeCertificate(folder_ + "/cert.pem", folder_ + "/key.pem", "DNS:localhost,IP:127.0.0.1");
    writeCertificate(folder_ + "/other.pem", folder_ + "/other_key.pem", "DNS:elsewhere.example");
    options_.certificate_file = folder_ + "/cert.pem";
    options_.key_file = folder_ + "/key.pem";
  }
  void TearDown() override {
    server_.reset();
    std::filesystem::remove_all(folder_);
  }
  std::string secure(const std::string& host) const { return "wss://" + host + ":" + std::to_string(port_) + "/"; }
  void expectSecureEcho() {
    for (const char* host : {"localhost", "127.0.0.1"}) {
      LoggedClient client(secure(host), {}, options_.certificate_file);
      ASSERT_TRUE(client.opens.waitFor(1));
      client.client->send(bytesOf(std::string(3000, 'x')));
      ASSERT_TRUE(client.messages.waitFor(1));
      EXPECT_EQ(client.messages.values()[0].size(), 3000u);
    }
  }

  std::string folder_;
};

TEST_F(Tls, EchoesWithACertificateThatTheClientTrusts) {
  start();
  expectSecureEcho();
}

TEST_F(Tls, SendsManyLargeMessages) {
  handler_.limits = {1 << 20, 1e6, 64 << 20};
  start();
  LoggedClient client(secure("localhost"), {}, options_.certificate_file);
  ASSERT_TRUE(client.opens.waitFor(1));
  for (size_t i = 0; i < 100; ++i) client.client->send(bytesOf(std::string(i * 1000, static_cast<char>('a' + i % 26))));
  ASSERT_TRUE(client.messages.waitFor(100));
  for (size_t i = 0; i < 100; ++i)
    ASSERT_EQ(client.messages.values()[i], std::string(i * 1000, static_cast<char>('a' + i % 26)));
}

TEST_F(Tls, ClientsRefuseACertificateThatNobodyTrusts) {
  start();
  LoggedClient client(secure("localhost"));
  ASSERT_TRUE(client.closes.waitFor(1));
  EXPECT_TRUE(client.opens.values().empty());
  EXPECT_NE(client.closes.values()[0].find("verify failed"), std::string::npos) << client.closes.values()[0];
}

TEST_F(Tls, ClientsRefuseACertificateOfAnotherHost) {
  options_.certificate_file = folder_ + "/other.pem";
  options_.key_file = folder_ + "/other_key.pem";
  start();
  LoggedClient client(secure("localhost"), {}, options_.certificate_file);
  ASSERT_TRUE(client.closes.waitFor(1));
  EXPECT_TRUE(client.opens.values().empty());
}

TEST_F(Tls, PlainBytesAndCutHandshakesHarmNobody) {
  start();
  EXPECT_EQ(statusOf(ask(port_, "GET /")), 0);
  RawSocket waiting(port_);
  RawSocket(port_).send("\x16\x03\x01");
  expectSecureEcho();
}

TEST_F(Tls, SaysWhichFileIsWrong) {
  options_.key_file = folder_ + "/missing.pem";
  const auto no_key = Server::start(options_, handler_);
  ASSERT_FALSE(no_key.ok());
  EXPECT_EQ(no_key.error().id, ErrorId::FileUnreadable);
  EXPECT_NE(no_key.error().message.find("missing.pem"), std::string::npos);
  options_.key_file = folder_ + "/other_key.pem";
  EXPECT_FALSE(Server::start(options_, handler_).ok());
  options_.certificate_file = folder_ + "/key.pem";
  EXPECT_FALSE(Server::start(options_, handler_).ok());
}

}  // namespace
}  // namespace fourdvt::live
