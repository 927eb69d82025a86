// SPDX-License-Identifier: Apache-2.0
// What an INDI focuser does while all is well, and where it stands when it was stopped.
#include <thread>

#include "support.hpp"

namespace fathom::test {
namespace {

TEST(IndiFocuser, AnAbsoluteOneGoesWhereItIsSent) {
  FakeServer server;
  const Hardware rig = open_lens(server, "settle_ms=30");
  const LensInfo info = rig.lens->info();
  EXPECT_EQ(info.lowest, 0);
  EXPECT_EQ(info.highest, 1000);  // FOCUS_MAX, though the position's own limit is 2000
  EXPECT_EQ(info.unit, "steps");
  EXPECT_EQ(rig.lens->position(), 500);
  const Arrival arrival = rig.lens->move_to(620.4);
  EXPECT_EQ(arrival.position, 620);
  EXPECT_EQ(server.motor(), 620);
  EXPECT_GE(arrival.settled_ns - arrival.stopped_ns, 30'000'000);
  expect_error(ErrorCode::unsupported, [&] { rig.lens->declare_at(3); });
  EXPECT_EQ(rig.lens->home().position, 0);
}

TEST(IndiFocuser, OneThatRestsBesideItsGoalIsBelievedAndAimedAnew) {
  for (const double miss : {-1.0, 1.0}) {
    FakeServer server;
    server.miss(miss);
    const Hardware rig = open_lens(server);
    EXPECT_EQ(rig.lens->move_to(620).position, 620);  // a second request has put it right
    EXPECT_EQ(server.requests("ABS_FOCUS_POSITION"), 2);
    EXPECT_EQ(rig.lens->move_to(700).position, 700);  // and is remembered
    EXPECT_EQ(server.requests("ABS_FOCUS_POSITION"), 3);
    server.miss(0);  // once only: what is inexact by chance is taken as it is
    EXPECT_EQ(rig.lens->move_to(300).position, 300 - miss);
    EXPECT_EQ(server.requests("ABS_FOCUS_POSITION"), 4);
  }
}

TEST(IndiFocuser, OneThatRestsFarFromItsGoalIsNotBelieved) {
  FakeServer server;
  server.miss(-40);
  const Hardware rig = open_lens(server);
  expect_error(ErrorCode::device_lost, [&] { rig.lens->move_to(620); }, {"stopped at 580", "620"});
}

TEST(IndiFocuser, TheWayBackUpWaitsUntilTheWayDownHasSettled) {
  FakeServer server;
  const Hardware rig = open_lens(server, "backlash=40,settle_ms=300");
  const Arrival arrival = rig.lens->move_to(300);
  EXPECT_GE(arrival.stopped_ns - arrival.started_ns, 300'000'000);
  EXPECT_EQ(server.lowest_motor(), 260);
}

TEST(IndiFocuser, BacklashIsTakenUpOnTheWayDown) {
  FakeServer server;
  const Hardware rig = open_lens(server, "backlash=40");
  rig.lens->move_to(300);
  EXPECT_EQ(server.requests("ABS_FOCUS_POSITION"), 2);
  rig.lens->move_to(400);
  EXPECT_EQ(server.requests("ABS_FOCUS_POSITION"), 3);
}

TEST(IndiFocuser, OnePositionIsOnePlaceFromTheFirstMoveOn) {
  FakeServer server;
  const Hardware rig = open_lens(server, "backlash=100");
  rig.lens->move_to(510);  // nobody knows from where it came to 500
  EXPECT_EQ(server.motor(), 510);
  EXPECT_EQ(server.lowest_motor(), 410);
  rig.lens->move_to(520);
  EXPECT_EQ(server.requests("ABS_FOCUS_POSITION"), 3);
  server.set("Foc", "ABS_FOCUS_POSITION", "FOCUS_ABSOLUTE_POSITION", "700");  // by somebody else
  rig.lens->move_to(710);
  EXPECT_EQ(server.requests("ABS_FOCUS_POSITION"), 5);
}

TEST(IndiFocuser, ThePlayIsTakenUpAfterAStoppedMove) {
  FakeServer server;
  std::atomic<int> requests = 0;
  const Hardware rig = open_lens(server, "backlash=100", [&] { return requests.load(); });
  rig.lens->move_to(1000);
  std::thread user([&] {
    while (server.motor() > 950) std::this_thread::sleep_for(1ms);
    requests = 1;
  });
  expect_error(ErrorCode::cancelled, [&] { rig.lens->move_to(0); });
  user.join();
  const int before = server.requests("ABS_FOCUS_POSITION");
  rig.lens->move_to(server.motor() + 10);
  EXPECT_EQ(server.requests("ABS_FOCUS_POSITION"), before + 2);
}

TEST(IndiFocuser, AStopRequestBringsItToRest) {
  FakeServer server;
  std::atomic<int> requests = 0;
  const Hardware rig = open_lens(server, "", [&] { return requests.load(); });
  rig.lens->move_to(0);
  std::thread user([&] {
    while (!server.is_moving()) std::this_thread::sleep_for(1ms);
    requests = 1;
  });
  expect_error(ErrorCode::cancelled, [&] { rig.lens->move_to(1000); });
  user.join();
  EXPECT_FALSE(server.is_moving());
  EXPECT_LT(server.motor(), 1000);
  EXPECT_EQ(rig.lens->position(), server.motor());
  EXPECT_EQ(rig.lens->move_to(10).position, 10);  // the request was answered
}

TEST(IndiFocuser, AStopRequestIsHeardWhileItSettles) {
  FakeServer server;
  std::atomic<int> requests = 0;
  const Hardware rig = open_lens(server, "settle_ms=20000", [&] { return requests.load(); });
  std::thread user([&] {
    while (server.motor() < 600) std::this_thread::sleep_for(1ms);
    std::this_thread::sleep_for(100ms);
    requests = 1;
  });
  expect_within(2s, [&] { expect_error(ErrorCode::cancelled, [&] { rig.lens->move_to(600); }); });
  user.join();
  EXPECT_EQ(rig.lens->position(), 600);
}

TEST(IndiFocuser, WhatMovesItByItselfIsOffWhileItIsOpen) {
  FakeServer server;
  server.add("Foc", "TEMPERATURE_COMPENSATION", "Switch",
             {{"INDI_ENABLED", "On"}, {"INDI_DISABLED", "Off"}});
  {
    const Hardware rig = open_lens(server);
    EXPECT_EQ(server.value("Foc", "TEMPERATURE_COMPENSATION", "INDI_DISABLED"), "On");
  }
  EXPECT_EQ(server.value("Foc", "TEMPERATURE_COMPENSATION", "INDI_ENABLED"), "On");
}

TEST(IndiFocuser, WhereARelativeOneStandsNobodyKnowsAtFirst) {
  FakeServer server(FocuserKind::relative);
  const Hardware rig = open_lens(server);
  expect_error(ErrorCode::unavailable, [&] { rig.lens->position(); }, {"start=", "home=true"});
  expect_error(ErrorCode::unavailable, [&] { rig.lens->move_to(10); });
  EXPECT_EQ(server.motor(), 500);
  rig.lens->declare_at(500);
  EXPECT_EQ(rig.lens->move_to(900).position, 900);  // 400 steps, where it takes 300 at once
  EXPECT_EQ(server.motor(), 900);
  EXPECT_EQ(rig.lens->move_to(850).position, 850);
  EXPECT_EQ(server.motor(), 850);
}

TEST(IndiFocuser, AnArrivalThatIsRepeatedIsNotBelieved) {
  FakeServer server(FocuserKind::relative);
  const Hardware rig = open_lens(server, "start=500");
  server.misbehave(Fault::late_busy);
  rig.lens->move_to(900);  // in two parts
  EXPECT_EQ(server.motor(), 900);
  EXPECT_FALSE(server.is_moving());
}

TEST(IndiFocuser, ARelativeOneFindsItsInnerStop) {
  FakeServer server(FocuserKind::relative);
  const Hardware rig = open_lens(server, "home=true");
  EXPECT_EQ(rig.lens->position(), 0);
  EXPECT_EQ(server.motor(), 0);
  rig.lens->move_to(70);
  EXPECT_EQ(rig.lens->home().position, 0);
  EXPECT_EQ(server.motor(), 0);
}

TEST(IndiFocuser, ARelativeOneThatWasStoppedIsNotBelieved) {
  FakeServer server(FocuserKind::relative);
  std::atomic<int> requests = 0;
  const Hardware rig = open_lens(server, "start=500", [&] { return requests.load(); });
  EXPECT_EQ(rig.lens->position(), 500);
  std::thread user([&] {
    while (!server.is_moving()) std::this_thread::sleep_for(1ms);
    requests = 1;
  });
  expect_error(ErrorCode::cancelled, [&] { rig.lens->move_to(0); });
  user.join();
  EXPECT_FALSE(server.is_moving());
  expect_error(ErrorCode::unavailable, [&] { rig.lens->position(); });
}

TEST(IndiFocuser, ARelativeOneMustSayHowFarItTravels) {
  FakeServer server(FocuserKind::relative);
  server.remove("Foc", "FOCUS_MAX");
  expect_error(ErrorCode::unsupported, [&] { open_lens(server); }, {"travel=STEPS"});
  EXPECT_EQ(open_lens(server, "travel=800").lens->info().highest, 800);
}

TEST(IndiFocuser, AnAbsoluteOneIsNotToldWhatItKnows) {
  FakeServer server;
  for (const char* key : {"start=500", "home=true", "travel=800"}) {
    const std::string name = std::string(key).substr(0, std::string(key).find('='));
    expect_error(ErrorCode::bad_argument, [&] { open_lens(server, key); },
                 {name.c_str(), "counts by itself"});
  }
  EXPECT_EQ(open_lens(server, "home=false").lens->position(), 500);
}

TEST(IndiFocuser, PlacesThatNobodyBuildsAreRefused) {
  FakeServer server;
  const Hardware rig = open_lens(server);
  for (const char* number : {"1e12", "-1e300", "inf"}) {
    server.set("Foc", "ABS_FOCUS_POSITION", "FOCUS_ABSOLUTE_POSITION", number);
    std::this_thread::sleep_for(20ms);
    expect_error(ErrorCode::bad_data, [&] { rig.lens->position(); }, {"stands at"});
    expect_error(ErrorCode::bad_data, [&] { rig.lens->move_to(100); });
  }
  EXPECT_EQ(server.requests("ABS_FOCUS_POSITION"), 0);
  FakeServer far(FocuserKind::relative);
  far.set("Foc", "FOCUS_MAX", "FOCUS_MAX_VALUE", "1e12");
  expect_error(ErrorCode::bad_data, [&] { open_lens(far); }, {"travels"});
}

TEST(IndiFocuser, SaysWhatIsNoFocuser) {
  FakeServer server;
  expect_error(ErrorCode::timeout, [&] { open_lens(server, "focuser=Cam"); }, {"focuser"});
}

}  // namespace
}  // namespace fathom::test
