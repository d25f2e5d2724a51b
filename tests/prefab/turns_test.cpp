#include "filasofia/prefab/turns.h"

#include "filasofia/core/published.h"

#include <catch2/catch.hpp>

#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace turns_test {

using namespace filasofia;
using prefab::Turns;

TEST_CASE("work is done at once if no other thread holds the state, also from within, and its exceptions are passed on")
{
    Turns turns;
    std::vector<int> done;
    turns.soon([&] {
        done.push_back(1);
        turns.soon([&] { done.push_back(2); });
        CHECK(turns.now([&] { done.push_back(3); }));
        done.push_back(4);
    });
    CHECK(done == std::vector<int>{1, 2, 3, 4});
    CHECK_THROWS_WITH(turns.soon([] { throw std::runtime_error("no"); }), "no");
    CHECK(turns.now([] {}));
}

TEST_CASE("a thread that finds the state taken does not wait: the holder does its work, in order")
{
    Turns turns;
    std::vector<std::thread::id> by;
    std::vector<int> done;
    std::atomic<bool> taken = false, goOn = false;
    std::thread holder([&] {
        turns.soon([&] {
            taken = true;
            while (!goOn) std::this_thread::yield();
            done.push_back(0);
        });
    });
    while (!taken) std::this_thread::yield();
    std::string logged;
    setLogSink([&](LogLevel, std::string_view line) { logged = line; });
    CHECK_FALSE(turns.now([&] { done.push_back(-1); }));
    for (int i = 1; i <= 3; ++i)
        turns.soon([&, i] {
            done.push_back(i);
            by.push_back(std::this_thread::get_id());
            if (i == 2) throw 42;
        });
    const std::thread::id other = holder.get_id();
    goOn = true;
    holder.join();
    setLogSink({});
    CHECK(done == std::vector<int>{0, 1, 2, 3});
    CHECK(by == std::vector<std::thread::id>(3, other));
    CHECK(logged == "it threw something that is not a std::exception");
}

TEST_CASE("no work that four threads leave to each other is lost, and none overlaps")
{
    Turns turns;
    int inside = 0, done = 0;
    bool alone = true;
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (int i = 0; i < 20'000; ++i)
                turns.soon([&] {
                    alone = alone && ++inside == 1;
                    ++done;
                    --inside;
                });
        });
    for (std::thread& thread : threads) thread.join();
    CHECK(alone);
    CHECK(done == 80'000);
}

TEST_CASE("published values are read whole and never go back, with any number of readers")
{
    struct Pair {
        std::vector<int> a = {0}, b = {0};
    };
    Published<Pair> published;
    CHECK(published.read().a == std::vector<int>{0});
    std::atomic<bool> done = false;
    std::atomic<int> wrong = 0;
    std::vector<std::thread> readers;
    for (int r = 0; r < 3; ++r)
        readers.emplace_back([&] {
            int last = 0;
            while (!done) {
                const Pair now = published.read();
                wrong += now.a != now.b || now.a.front() < last;
                last = now.a.front();
            }
        });
    for (int i = 1; i <= 20'000; ++i) published.write({std::vector<int>(5, i), std::vector<int>(5, i)});
    done = true;
    for (std::thread& reader : readers) reader.join();
    CHECK(wrong == 0);
    CHECK(published.read().a.front() == 20'000);
}

} // namespace turns_test
