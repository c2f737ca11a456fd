// As many threads as a job may use, where nobody says how many.

#include "core/machine/processors.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <cstdlib>

namespace photonlab {
namespace {

class Processors : public ::testing::Test {
protected:
    Processors() {
        sched_getaffinity(0, sizeof(mask_), &mask_);
        unsetenv("SLURM_CPUS_PER_TASK");
    }
    ~Processors() override {
        sched_setaffinity(0, sizeof(mask_), &mask_);
        unsetenv("SLURM_CPUS_PER_TASK");
    }

    cpu_set_t mask_;
};

TEST_F(Processors, AreThoseOfTheMask) {
    EXPECT_EQ(usable_processors(), CPU_COUNT(&mask_));
    int first = 0;
    while (!CPU_ISSET(first, &mask_)) ++first;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof(one), &one), 0);
    EXPECT_EQ(usable_processors(), 1);
}

TEST_F(Processors, AreThoseOfTheJobWhereSlurmSaysSo) {
    setenv("SLURM_CPUS_PER_TASK", "37", 1);
    EXPECT_EQ(usable_processors(), 37);
    for (const char* nothing : {"", "0", "-2", "4x", "many", "99999999999"}) {
        setenv("SLURM_CPUS_PER_TASK", nothing, 1);
        EXPECT_EQ(usable_processors(), CPU_COUNT(&mask_)) << nothing;
    }
}

}  // namespace
}  // namespace photonlab
