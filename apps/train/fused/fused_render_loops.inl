// The loops of the fused renderer: blocks of points through two hidden layers of one width, forward
// and backward. Included once for each instruction set, in a namespace of its own that says how wide
// its registers are (kVectorBytes) and how many it has (kRegisters): compilers take wider vectors
// apart through memory.

/// A row of numbers as vectors: compilers keep these in registers where arrays spill.
template <int H, typename W>
struct Row {
    static constexpr int kLanes = kVectorBytes / int(sizeof(W)), kCount = H / kLanes;
    /// Rows summed together: three of four registers hold sums, the rest what is multiplied.
    static constexpr int kTogether = std::clamp(kRegisters * 3 / 4 / kCount / 2 * 2, 1, 4);
    typedef W V __attribute__((vector_size(kVectorBytes)));
    /// A vector among numbers. A copy of the whole row by memcpy would go through the stack.
    typedef W InMemory __attribute__((vector_size(kVectorBytes), aligned(sizeof(W)), may_alias));
    V part[kCount];

    EVENTIDE_INLINE static Row zero() {
        Row row;
        for (int j = 0; j < kCount; ++j) row.part[j] = V{};
        return row;
    }
    EVENTIDE_INLINE static Row load(const W* from) {
        Row row;
        for (int j = 0; j < kCount; ++j)
            row.part[j] = reinterpret_cast<const InMemory*>(from)[j];
        return row;
    }
    EVENTIDE_INLINE void store(W* to) const {
        for (int j = 0; j < kCount; ++j) reinterpret_cast<InMemory*>(to)[j] = part[j];
    }
    EVENTIDE_INLINE void add(W factor, const Row& other) {
        for (int j = 0; j < kCount; ++j) part[j] += factor * other.part[j];
    }
    EVENTIDE_INLINE void add(const Row& other) {
        for (int j = 0; j < kCount; ++j) part[j] += other.part[j];
    }
    /// Numbers where `where` is above 0, else 0.
    EVENTIDE_INLINE Row above_zero(const Row& where) const {
        Row row;
        for (int j = 0; j < kCount; ++j) row.part[j] = where.part[j] > 0 ? part[j] : V{};
        return row;
    }
    EVENTIDE_INLINE W dot(const Row& other) const {
        V sum = part[0] * other.part[0];
        for (int j = 1; j < kCount; ++j) sum += part[j] * other.part[j];
        W stream[kLanes];
        std::memcpy(stream, &sum, sizeof stream);
        for (int step = kLanes / 2; step > 0; step /= 2)
            for (int k = 0; k < step; ++k) stream[k] += stream[k + step];
        return stream[0];
    }
};

/// y = x w, [kPoints][H] each, w [H][H] as [in][out]; every row begins as `start`.
template <int H, typename W>
EVENTIDE_INLINE void product(const W* x, const W* w, const Row<H, W>& start, W* y) {
    constexpr int kTogether = Row<H, W>::kTogether;
    for (int p = 0; p < kPoints; p += kTogether) {
        Row<H, W> sum[kTogether];
        for (int q = 0; q < kTogether; ++q) sum[q] = start;
        for (int i = 0; i < H; ++i) {
            const auto row = Row<H, W>::load(w + i * H);
            for (int q = 0; q < kTogether; ++q) sum[q].add(x[(p + q) * H + i], row);
        }
        for (int q = 0; q < kTogether; ++q) sum[q].store(y + (p + q) * H);
    }
}

/// sum[i][o] += over points x[p][i] g[p][o].
template <int H, typename W>
EVENTIDE_INLINE void outer_product(const W* x, const W* g, W* sum) {
    constexpr int kTogether = Row<H, W>::kTogether;
    for (int i = 0; i < H; i += kTogether) {
        Row<H, W> part[kTogether];
        for (int q = 0; q < kTogether; ++q) part[q] = Row<H, W>::load(sum + (i + q) * H);
        for (int p = 0; p < kPoints; ++p) {
            const auto row = Row<H, W>::load(g + p * H);
            for (int q = 0; q < kTogether; ++q) part[q].add(x[p * H + i + q], row);
        }
        for (int q = 0; q < kTogether; ++q) part[q].store(sum + (i + q) * H);
    }
}

/// Rectified layers and outputs of the block; points beyond its count are zeros.
template <int H, typename T, typename W>
EVENTIDE_INLINE void run_points(const RenderWeights<H, W>& w, const PointBlock<W>& block,
                                const T* map, PointRoom<H, W>& room) {
    const auto ox = Row<H, W>::load(w.offset.data() + H);
    auto same = Row<H, W>::zero();  // what dt and dy add
    same.add(block.dt, Row<H, W>::load(w.offset.data()));
    same.add(block.dy, Row<H, W>::load(w.offset.data() + 2 * H));
    for (int p = 0; p < kPoints; ++p) {
        W* at = room.first.data() + p * H;
        auto x = Row<H, W>::zero();
        if (p < block.count) {
            const T* from = map + block.sample[std::size_t(p)];
            for (int k = 0; k < H; ++k) at[k] = W(from[k]);
            x = Row<H, W>::load(at);
            x.add(same);
            x.add(block.dx[std::size_t(p)], ox);
        }
        x.above_zero(x).store(at);
    }
    product<H, W>(room.first.data(), w.hidden.data(), Row<H, W>::load(w.hidden_bias.data()),
                  room.second.data());
    const auto to_mu = Row<H, W>::load(w.last.data()), to_s = Row<H, W>::load(w.last.data() + H);
    for (int p = 0; p < kPoints; ++p) {
        W* at = room.second.data() + p * H;
        const auto sums = Row<H, W>::load(at), y = sums.above_zero(sums);
        y.store(at);
        room.mu[std::size_t(p)] = w.last_bias[0] + y.dot(to_mu);
        room.s[std::size_t(p)] = w.last_bias[1] + y.dot(to_s);
    }
}

/// Adds the block's weighted outputs to out_mu and out_second, of its `count` points in a row.
template <int H, typename T, typename W>
void render_forward(const RenderWeights<H, W>& w, const PointBlock<W>& block, const T* map,
                    PointRoom<H, W>& room, W* out_mu, W* out_second) {
    run_points<H, T, W>(w, block, map, room);
    for (int p = 0; p < block.count; ++p) {
        const auto i = std::size_t(p);
        const W s = std::clamp(room.s[i], w.low, w.high);
        out_mu[p] += block.weight[i] * room.mu[i];
        out_second[p] +=
            block.weight[i] * (w.squares ? std::exp(2 * s) + room.mu[i] * room.mu[i] : s);
    }
}

/// The block's part of all gradients; g_map has the map's shape.
template <int H, typename T, typename W>
void render_backward(const RenderWeights<H, W>& w, const PointBlock<W>& block, const T* map,
                     const W* g_mu, const W* g_second, PointRoom<H, W>& room, W* g_map,
                     RenderGradients<H, W>& g) {
    run_points<H, T, W>(w, block, map, room);
    const Row<H, W> last[] = {Row<H, W>::load(w.last.data()), Row<H, W>::load(w.last.data() + H)};
    Row<H, W> g_last[] = {Row<H, W>::load(g.last.data()), Row<H, W>::load(g.last.data() + H)};
    auto g_bias = Row<H, W>::load(g.hidden_bias.data());
    for (int p = 0; p < kPoints; ++p) {
        const auto i = std::size_t(p);
        W to_mu = 0, to_s = 0;
        if (p < block.count) {
            const bool inside = room.s[i] >= w.low && room.s[i] <= w.high;
            const W second = block.weight[i] * g_second[p];
            to_mu = block.weight[i] * g_mu[p] + (w.squares ? 2 * room.mu[i] * second : W(0));
            to_s = !inside ? W(0) : w.squares ? 2 * std::exp(2 * room.s[i]) * second : second;
        }
        g.last_bias[0] += to_mu;
        g.last_bias[1] += to_s;
        const auto y = Row<H, W>::load(room.second.data() + p * H);
        g_last[0].add(to_mu, y);
        g_last[1].add(to_s, y);
        auto gy = Row<H, W>::zero();
        gy.add(to_mu, last[0]);
        gy.add(to_s, last[1]);
        gy = gy.above_zero(y);
        gy.store(room.g_second.data() + p * H);
        g_bias.add(gy);
    }
    g_last[0].store(g.last.data());
    g_last[1].store(g.last.data() + H);
    g_bias.store(g.hidden_bias.data());
    outer_product<H, W>(room.first.data(), room.g_second.data(), g.hidden.data());
    product<H, W>(room.g_second.data(), w.turned.data(), Row<H, W>::zero(), room.g_first.data());
    auto sum = Row<H, W>::zero(), sum_dx = sum;
    for (int p = 0; p < block.count; ++p) {
        const auto gx = Row<H, W>::load(room.g_first.data() + p * H)
                            .above_zero(Row<H, W>::load(room.first.data() + p * H));
        W* to = g_map + block.sample[std::size_t(p)];
        auto there = Row<H, W>::load(to);
        there.add(gx);
        there.store(to);
        sum.add(gx);
        sum_dx.add(block.dx[std::size_t(p)], gx);
    }
    const W factor[] = {block.dt, W(1), block.dy};
    for (int d = 0; d < 3; ++d) {
        auto to = Row<H, W>::load(g.offset.data() + d * H);
        to.add(factor[d], d == 1 ? sum_dx : sum);
        to.store(g.offset.data() + d * H);
    }
}
