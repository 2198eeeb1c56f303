// Batches in pieces: nothing is lost, and images come before the events that follow them.
#include "src/core/batch_pieces.h"

#include <gtest/gtest.h>

#include <random>

namespace eventide {
namespace {

Event event_at(std::int64_t t) {
    return {from_us(t), 1, 2, Polarity::on};
}

ReferenceImage image_at(std::int64_t t) {
    ReferenceImage image;
    image.t = from_us(t);
    return image;
}

std::vector<Batch> pieces_of(Batch batch) {
    std::vector<Batch> all;
    BatchPieces pieces{batch};
    EXPECT_TRUE(batch.empty());
    for (Batch piece; pieces.next(piece);) all.push_back(piece);
    Batch none;
    EXPECT_FALSE(pieces.next(none));
    return all;
}

TEST(BatchPieces, AreOneWhereNoImageCameAmongEvents) {
    EXPECT_EQ(pieces_of({}).size(), 0U);
    Batch batch;
    batch.add_image(image_at(5));
    batch.events = {event_at(1), event_at(2)};
    batch.imu.resize(2);
    const std::vector<Batch> pieces = pieces_of(batch);
    ASSERT_EQ(pieces.size(), 1U);
    EXPECT_EQ(pieces[0].events, batch.events);
    EXPECT_EQ(pieces[0].images, batch.images);
    EXPECT_EQ(pieces[0].imu.size(), 2U);
}

TEST(BatchPieces, BeginWithTheImages) {
    Batch batch;
    batch.events = {event_at(1), event_at(2)};
    batch.add_image(image_at(1));
    batch.add_image(image_at(2));
    batch.events.push_back(event_at(3));
    batch.add_image(image_at(3));
    batch.triggers = {{.t = from_us(0)}, {.t = from_us(2)}, {.t = from_us(3)}};
    const std::vector<Batch> pieces = pieces_of(batch);
    ASSERT_EQ(pieces.size(), 3U);
    EXPECT_EQ(pieces[0].events.size(), 2U);
    EXPECT_EQ(pieces[0].images.size(), 0U);
    EXPECT_EQ(pieces[0].triggers.size(), 2U);
    EXPECT_EQ(pieces[1].images, (std::vector{image_at(1), image_at(2)}));
    EXPECT_EQ(pieces[1].events, std::vector{event_at(3)});
    EXPECT_EQ(pieces[1].triggers.size(), 1U);
    EXPECT_EQ(pieces[2].images, std::vector{image_at(3)});
    EXPECT_EQ(pieces[2].events.size(), 0U);
}

TEST(BatchPieces, HoldAllOfTheBatchInOrder) {
    std::mt19937 random{4};
    for (int trial = 0; trial < 200; ++trial) {
        Batch batch;
        for (std::int64_t t = 0; t < 30; ++t) {
            if (random() % 2 == 0) batch.events.push_back(event_at(t));
            if (random() % 6 == 0) batch.add_image(image_at(t - 3));
            if (random() % 3 == 0) batch.imu.push_back({.t = from_us(t)});
            if (random() % 9 == 0) batch.triggers.push_back({.t = from_us(t)});
        }
        if (random() % 4 == 0 && !batch.image_places.empty())  // what a filter forgot to tell
            batch.image_places.back() += 40;
        Batch all;
        for (const Batch& piece : pieces_of(batch)) {
            for (const ReferenceImage& image : piece.images) all.add_image(image);
            all.events.insert(all.events.end(), piece.events.begin(), piece.events.end());
            all.imu.insert(all.imu.end(), piece.imu.begin(), piece.imu.end());
            all.triggers.insert(all.triggers.end(), piece.triggers.begin(), piece.triggers.end());
        }
        EXPECT_EQ(all.events, batch.events);
        EXPECT_EQ(all.images, batch.images);
        for (std::size_t& place : batch.image_places) place = std::min(place, batch.events.size());
        EXPECT_EQ(all.image_places, batch.image_places);
        EXPECT_EQ(all.imu, batch.imu);
        EXPECT_EQ(all.triggers, batch.triggers);
    }
}

}  // namespace
}  // namespace eventide
