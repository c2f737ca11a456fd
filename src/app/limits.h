// What the system allows a process: memory, threads, open files, the stack. Where that is too little it is said, with
// what allows no more, before libraries meet it: some of them end the program then.

#pragma once

#include <string>

namespace photonlab {

/// Raises what the process may raise itself: open files, of which runs that are made together hold one each, and the
/// stack. True when the stack was raised, which threads have only after the program has started once more.
bool raise_limits();

/// Throws InputError when the stack is too small.
void require_stack();

/// Starts the threads that OpenMP is going to use. Throws InputError when there cannot be so many.
void start_threads(int threads);

/// Starts as many of them as there can be, beside the work that is to be done; returns how many those are.
int start_threads_up_to(int threads);

/// What is said when memory was asked for in vain.
std::string no_memory_message();

/// What is said when the process has as good as no memory left, or can start no thread; empty otherwise.
std::string limit_message();

}  // namespace photonlab
