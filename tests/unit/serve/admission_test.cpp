// SPDX-License-Identifier: Apache-2.0
#include "serve/admission.hpp"

#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"

namespace fathom::serve {
namespace {

const House kHouse{.token = "0123456789abcdef", .cookie_name = "fathom_token_8470"};

Visitor guest() {
  Visitor visitor;
  visitor.method = "GET";
  visitor.path = "/api/v1/state";
  visitor.hosts = {"127.0.0.1:8470"};
  visitor.authorization = "Bearer 0123456789abcdef";
  return visitor;
}

Visitor poster() {
  Visitor visitor = guest();
  visitor.method = "POST";
  visitor.lengths = {"2"};
  visitor.content_type = "application/json";
  return visitor;
}

TEST(Admission, LetsInWhoBringsTheTokenByAnyOfThreeWays) {
  EXPECT_EQ(admit(guest(), kHouse), Refusal::none);
  Visitor by_cookie = guest();
  by_cookie.authorization = "";
  by_cookie.cookie = "a=b; fathom_token_8470=0123456789abcdef; c=d";
  EXPECT_EQ(admit(by_cookie, kHouse), Refusal::none);
  Visitor by_query = guest();
  by_query.authorization = "";
  by_query.query_token = kHouse.token;
  EXPECT_EQ(admit(by_query, kHouse), Refusal::none);
}

TEST(Admission, KnowsATokenThatIsNearlyRight) {
  for (const char* said : {"", "Bearer ", "Bearer 0123456789abcde", "Bearer 0123456789abcdeg",
                           "Bearer 0123456789abcdef0123456789abcdef", "Basic 0123456789abcdef"}) {
    Visitor visitor = guest();
    visitor.authorization = said;
    EXPECT_EQ(admit(visitor, kHouse), Refusal::no_token) << said;
  }
  Visitor other_port = guest();
  other_port.authorization = "";
  other_port.cookie = "fathom_token_8471=0123456789abcdef; xfathom_token_8470=0123456789abcdef";
  EXPECT_EQ(admit(other_port, kHouse), Refusal::no_token);
}

TEST(Admission, AnEmptySecretOpensNothing) {
  EXPECT_FALSE(same_secret("", ""));
  EXPECT_FALSE(same_secret("a", ""));
  EXPECT_TRUE(same_secret("ab", "ab"));
}

TEST(Admission, HostsAreNumbersLocalhostAndOwnNames) {
  for (const char* host : {"127.0.0.1", "127.0.0.1:8470", "192.168.1.7:9000", "localhost:1",
                           "LocalHost", "[::1]:8470", "[::1]", "bench.lab:80"})
    EXPECT_TRUE(is_our_host(host, {"bench.lab"})) << host;
  for (const char* host :
       {"", "evil.example", "evil.example:8470", "localhost.evil.example", "127.0.0.1.evil.example",
        "127.0.0.1:8470:1", "[::1", "[::1]x", "localhost:", "localhost:80a", "1.2.3"})
    EXPECT_FALSE(is_our_host(host, {"bench.lab"})) << host;
}

TEST(Admission, RefusesForeignAndDoubledHosts) {
  Visitor visitor = guest();
  visitor.hosts = {"evil.example"};
  EXPECT_EQ(admit(visitor, kHouse), Refusal::foreign_host);
  visitor.hosts = {};
  EXPECT_EQ(admit(visitor, kHouse), Refusal::foreign_host);
  visitor.hosts = {"127.0.0.1:8470", "evil.example"};
  EXPECT_EQ(admit(visitor, kHouse), Refusal::foreign_host);
}

TEST(Admission, RefusesPagesOfOtherSitesEvenWithTheToken) {
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1:8470",
                             "http://127.0.0.1:8471", "http://localhost:8470"}) {
    Visitor visitor = poster();
    visitor.origins = {origin};
    EXPECT_EQ(admit(visitor, kHouse), Refusal::foreign_origin) << origin;
  }
  Visitor own = poster();
  own.origins = {"http://127.0.0.1:8470"};
  EXPECT_EQ(admit(own, kHouse), Refusal::none);
}

TEST(Admission, RefusesBodiesThatAreNotPlainJson) {
  struct Case {
    Refusal expected;
    std::vector<std::string> lengths;
    const char* type;
  };
  for (const Case& one :
       {Case{Refusal::none, {"65536"}, "application/json; charset=utf-8"},
        Case{Refusal::no_length, {}, "application/json"},
        Case{Refusal::large_body, {"65537"}, "application/json"},
        Case{Refusal::large_body, {"99999999999999999999999999"}, "application/json"},
        Case{Refusal::unclear_length, {"-1"}, "application/json"},
        Case{Refusal::unclear_length, {"2 "}, "application/json"},
        Case{Refusal::unclear_length, {"2", "2"}, "application/json"},
        Case{Refusal::not_json, {"2"}, "text/plain"}, Case{Refusal::not_json, {"2"}, ""},
        Case{Refusal::not_json, {"2"}, "application/jsonx"}}) {
    Visitor visitor = poster();
    visitor.lengths = one.lengths;
    visitor.content_type = one.type;
    EXPECT_EQ(admit(visitor, kHouse), one.expected) << one.type;
  }
  Visitor chunked = poster();
  chunked.is_chunked = true;
  EXPECT_EQ(admit(chunked, kHouse), Refusal::no_length);
}

TEST(Admission, RefusesOtherMethodsLongPathsAndBodiesOfGets) {
  Visitor visitor = guest();
  visitor.method = "PUT";
  EXPECT_EQ(admit(visitor, kHouse), Refusal::method);
  visitor = guest();
  visitor.path = std::string(kLongestPath + 1, 'a');
  EXPECT_EQ(admit(visitor, kHouse), Refusal::long_path);
  visitor = guest();
  visitor.lengths = {"1"};
  EXPECT_EQ(admit(visitor, kHouse), Refusal::body_of_get);
}

TEST(Admission, EveryRefusalHasAStatusANameAndWords) {
  for (const Refusal refusal :
       {Refusal::method, Refusal::long_path, Refusal::foreign_host, Refusal::foreign_origin,
        Refusal::no_token, Refusal::body_of_get, Refusal::no_length, Refusal::unclear_length,
        Refusal::large_body, Refusal::not_json}) {
    EXPECT_GE(status_of(refusal), 400);
    EXPECT_NE(*code_of(refusal), '\0');
    EXPECT_NE(*words_of(refusal), '\0');
  }
}

TEST(Admission, TokensAreDrawnAndWeakOnesRefused) {
  EXPECT_EQ(random_token().size(), 32u);
  EXPECT_NE(random_token(), random_token());
  require_token(random_token());
  for (const char* token : {"", "short", "with space in it", "semi;colon;semi", "a\nb\nc\nd\ne"})
    test::expect_error(ErrorCode::bad_argument, [&] { require_token(token); }, {"8 to 128"});
}

TEST(Admission, ClientNamesArePlain) {
  EXPECT_TRUE(is_client_name("a-1"));
  EXPECT_FALSE(is_client_name(""));
  EXPECT_FALSE(is_client_name("a\"b"));
  EXPECT_FALSE(is_client_name(std::string(65, 'a')));
}

}  // namespace
}  // namespace fathom::serve
