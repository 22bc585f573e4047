// SPDX-License-Identifier: Apache-2.0
#include "live/events.h"

#include <gtest/gtest.h>

#include <thread>

namespace events_test {

using namespace nonio::live;
using namespace std::chrono_literals;

TEST(LiveEvents, TextHasOneLineOfData) {
  EXPECT_EQ(event_text({17, "fit", "X", "{\"a\":1}"}), "id: 17\nevent: fit\ndata: {\"a\":1}\n\n");
  EXPECT_EQ(event_text({1, "fit", "", "a\n\nevent: b\r"}),
            "id: 1\nevent: fit\ndata: aevent: b\n\n");
}

TEST(LiveEvents, TheNewestOfASubjectWins) {
  Events events;
  const auto page = events.listen(0);
  for (std::uint64_t i = 1; i <= 100; ++i) {
    events.publish({i, "progress", "X", std::to_string(i)});
    events.publish({i, "progress", "Y", std::to_string(i)});
  }
  const auto got = page->wait(1s);
  ASSERT_EQ(got.size(), 2U);
  EXPECT_EQ(got[0].data, "100");
  EXPECT_TRUE(page->wait(1ms).empty());
}

TEST(LiveEvents, WhoComesBackGetsWhatWasMissedOnce) {
  Events events;
  for (std::uint64_t i = 1; i <= 5; ++i) events.publish({i, "state", "", std::to_string(i)});
  events.publish({3, "fit", "X", "x"});
  events.publish({6, "fit", "Y", "y"});
  const auto page = events.listen(5);
  const auto got = page->wait(1s);
  ASSERT_EQ(got.size(), 2U);
  EXPECT_EQ(got[0].type, "state");
  EXPECT_EQ(got[1].about, "Y");
  EXPECT_EQ(events.listen(7)->wait(1s).size(), 3U);  // of an earlier server: all
  EXPECT_TRUE(events.listen(6)->wait(1ms).size() == 1U);
}

TEST(LiveEvents, EightListenAtMost) {
  Events events;
  std::vector<std::shared_ptr<Listener>> all;
  for (std::size_t i = 0; i < Events::most_listeners; ++i) all.push_back(events.listen(0));
  EXPECT_EQ(events.listen(0), nullptr);
  events.leave(all.front());
  EXPECT_NE(events.listen(0), nullptr);
  EXPECT_EQ(events.listeners(), Events::most_listeners);
}

TEST(LiveEvents, TheEndWakesAll) {
  Events events;
  const auto page = events.listen(0);
  std::thread waiting([&] { EXPECT_TRUE(page->wait(60s).empty()); });
  events.close();
  waiting.join();
  EXPECT_TRUE(page->closed());
  EXPECT_EQ(events.listen(0), nullptr);
}

TEST(LiveEvents, ManySendAndListenAtOnce) {
  Events events;
  std::vector<std::thread> all;
  for (int t = 0; t < 4; ++t)
    all.emplace_back([&events, t] {
      for (std::uint64_t i = 1; i <= 500; ++i)
        events.publish({i, "fit", std::to_string(t), std::to_string(i)});
    });
  for (int t = 0; t < 4; ++t)
    all.emplace_back([&events] {
      for (int i = 0; i < 50; ++i) {
        const auto page = events.listen(0);
        ASSERT_NE(page, nullptr);
        EXPECT_LE(page->wait(10ms).size(), 4U);
        events.leave(page);
      }
    });
  for (std::thread& one : all) one.join();
  EXPECT_EQ(events.listeners(), 0U);
}

}  // namespace events_test
