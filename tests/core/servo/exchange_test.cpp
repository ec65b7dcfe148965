// Values passed between threads arrive whole, in order and once, or only the newest.
#include "palpate/exchange.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>
#include <variant>
#include <vector>

using namespace palpate;

namespace {

/// A value that shows whether it is whole: every word is the same.
struct Words {
    std::array<std::uint64_t, 41> word{};

    static Words of(std::uint64_t number) {
        Words words;
        words.word.fill(number);
        return words;
    }
    bool whole() const {
        for (const std::uint64_t w : word) {
            if (w != word[0]) return false;
        }
        return true;
    }
};

TEST(Newest, has_nothing_before_the_first_value) {
    const Newest<int> newest;
    EXPECT_FALSE(newest.get());
    EXPECT_EQ(newest.count(), 0U);
}

TEST(Newest, gives_the_last_value_again_and_again) {
    Newest<Words> newest;
    for (std::uint64_t i = 1; i <= 9; ++i) newest.put(Words::of(i));
    for (int i = 0; i < 3; ++i) EXPECT_EQ(newest.get()->word[40], 9U);
    EXPECT_EQ(newest.count(), 9U);
}

TEST(Newest, keeps_odd_sizes_whole) {
    struct Odd {
        char text[13];
    };
    Newest<Odd> newest;
    newest.put({"twelve chars"});
    EXPECT_STREQ(newest.get()->text, "twelve chars");
}

TEST(Newest, many_readers_of_a_fast_writer_see_whole_values_that_never_go_back) {
    Newest<Words> newest;
    std::atomic<bool> done{false};
    std::atomic<std::int64_t> torn{0}, back{0}, got{0};
    std::vector<std::jthread> readers;
    for (int r = 0; r < 3; ++r) {
        readers.emplace_back([&] {
            std::uint64_t last = 0;
            while (!done.load()) {
                const auto value = newest.get();
                if (!value) continue;
                ++got;
                torn += !value->whole();
                back += value->word[0] < last;
                last = value->word[0];
            }
        });
    }
    std::uint64_t number = 0;
    // Until there was something to see, at most so many.
    while (number < 200'000 || (got.load() < 1000 && number < 200'000'000)) {
        newest.put(Words::of(++number));
    }
    done = true;
    readers.clear();
    EXPECT_EQ(torn, 0);
    EXPECT_EQ(back, 0);
    EXPECT_GE(got, 1000);
    EXPECT_EQ(newest.get()->word[0], number);
}

TEST(Queue, gives_values_in_their_order_and_then_nothing) {
    Queue<int> queue(4);
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(queue.push(i));
    for (int i = 0; i < 3; ++i) EXPECT_EQ(queue.pop(), i);
    EXPECT_FALSE(queue.pop());
}

TEST(Queue, refuses_what_it_has_no_room_for_and_goes_on_when_it_has) {
    Queue<int> queue(5);
    const auto room = static_cast<int>(queue.capacity());
    EXPECT_GE(room, 5);
    for (int round = 0; round < 7; ++round) {
        for (int i = 0; i < room; ++i) EXPECT_TRUE(queue.push(i));
        EXPECT_FALSE(queue.push(99));
        for (int i = 0; i < room; ++i) EXPECT_EQ(queue.pop(), i);
        EXPECT_FALSE(queue.pop());
    }
}

TEST(Queue, many_pushers_lose_nothing_and_keep_each_ones_order) {
    constexpr int pushers = 4;
    constexpr int each = 20'000;
    struct Item {
        int pusher = 0, number = 0;
    };
    Queue<Item> queue(64);  // full most of the time
    std::vector<std::jthread> threads;
    for (int p = 0; p < pushers; ++p) {
        threads.emplace_back([&, p] {
            for (int i = 0; i < each; ++i) {
                while (!queue.push({p, i})) std::this_thread::yield();
            }
        });
    }
    std::array<int, pushers> next{};
    for (int taken = 0; taken < pushers * each;) {
        const auto item = queue.pop();
        if (!item) {
            std::this_thread::yield();
            continue;
        }
        ++taken;
        ASSERT_EQ(item->number, next[static_cast<std::size_t>(item->pusher)]++);
    }
    EXPECT_FALSE(queue.pop());
}

TEST(Queue, a_cell_that_was_popped_holds_nothing) {
    Queue<std::variant<int, std::shared_ptr<int>>> queue(4);
    for (int round = 0; round < 10; ++round) {
        const auto value = std::make_shared<int>(round);
        queue.push(value);
        queue.push(value);
        EXPECT_EQ(value.use_count(), 3);
        {
            const auto popped = queue.pop();
            EXPECT_EQ(std::get<1>(*popped), value);
            EXPECT_EQ(value.use_count(), 3);  // it went over
        }
        EXPECT_EQ(value.use_count(), 2);
        queue.pop();
        EXPECT_EQ(value.use_count(), 1);
    }
}

}  // namespace
