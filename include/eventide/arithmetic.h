/// @file
/// With which numbers a network is computed, and by whose code.
#pragma once

namespace eventide {

/// The numbers products are made of in the fast engine. Sums, states and outputs are always
/// float32.
enum class Precision {
    automatic,  ///< bf16 where the processor has it and it measured faster in this process, else
                ///< f32
    f32,        ///< float32, everywhere
    bf16,       ///< Error(usage) where the processor does not offer it
};

/// Whose convolutions the fast engine calls. Which one changes the last bits of the results; each
/// gives the same bits in every run and with any number of threads.
enum class Kernels {
    automatic,  ///< own; in bf16 oneDNN's where the processor has AMX and they measured faster in
                ///< this process
    own,        ///< ours: allocation-free
    onednn,     ///< oneDNN's: a few small allocations per call. Error(usage) where not built in
};

}  // namespace eventide
