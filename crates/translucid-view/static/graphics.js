// Pictures on a graphics processor, by WebGPU: drives the kernels of `translucid-gpu`, whose `program.rs` says what they need.

/** Aim for the length of what is submitted at once, in milliseconds: browsers end what takes long. */
const PACE = 40;
/** Words of a job before its settings: its number, side, items, and whether a scene follows. */
const JOB = 4;
/** The arrays of a scene. */
const ARRAYS = 5;

/** The best graphics processor: its adapter, name, and whether it only pretends to be one; null where there is none. */
export async function findAdapter() {
    const adapter = await globalThis.navigator.gpu?.requestAdapter({ powerPreference: "high-performance" }).catch(() => null);
    if (!adapter) return null;
    const { vendor, architecture, description, isFallbackAdapter } = adapter.info;
    const name = description || [vendor, architecture].filter(Boolean).join(" ");
    return { adapter, name: name ? `WebGPU: ${name}` : "WebGPU", isSlow: Boolean(isFallbackAdapter) };
}

export class Graphics {
    #device;
    #program;
    #kernels;
    #layout;
    #slots;
    #rounds = 1;
    /** The arrays of the scene of each side. */
    #scenes = [null, null];
    #buffers;

    /** Makes the kernels, which takes seconds. Throws what is wrong with the device. */
    static async open({ adapter, isSlow }, program) {
        const graphics = new Graphics();
        const { maxStorageBufferBindingSize, maxBufferSize } = adapter.limits;
        const device = await adapter.requestDevice({ requiredLimits: { maxStorageBufferBindingSize, maxBufferSize } });
        graphics.#device = device;
        graphics.#program = program;
        graphics.#slots = program.slots[Number(isSlow)];
        const module = device.createShaderModule({ code: program.code });
        const type = (binding) => (binding === 0 ? "uniform" : binding <= ARRAYS ? "read-only-storage" : "storage");
        const entries = Array.from({ length: 9 }, (_, binding) => ({ binding, visibility: GPUShaderStage.COMPUTE, buffer: { type: type(binding) } }));
        graphics.#layout = device.createBindGroupLayout({ entries });
        const layout = device.createPipelineLayout({ bindGroupLayouts: [graphics.#layout] });
        const make = async ([entryPoint, share]) => ({ share, pipeline: await device.createComputePipelineAsync({ layout, compute: { module, entryPoint } }) });
        graphics.#kernels = await Promise.all(program.kernels.map(make));
        const { STORAGE, UNIFORM, COPY_DST, COPY_SRC, MAP_READ } = GPUBufferUsage;
        const [first, end] = program.listCounters;
        graphics.#buffers = {
            settings: graphics.#buffer(4 * program.settings, UNIFORM | COPY_DST),
            states: graphics.#buffer(program.slotBytes * graphics.#slots, STORAGE | COPY_DST),
            queues: graphics.#buffer(4 * (program.counters + (end - first) * graphics.#slots), STORAGE | COPY_DST | COPY_SRC),
            counters: graphics.#buffer(4 * program.counters, MAP_READ | COPY_DST),
        };
        return graphics;
    }

    /** Traces a job: its samples as bytes, or none where `isWanted` says so on the way. */
    async trace(job, isWanted) {
        const words = new Uint32Array(job.buffer, job.byteOffset, job.byteLength / 4);
        const [, side, items, hasScene] = words;
        const settings = words.slice(JOB, JOB + this.#program.settings);
        // Paths at a time
        const slots = Math.min(this.#slots, items);
        settings[30] = slots;
        if (hasScene) this.#take(side, words.subarray(JOB + settings.length));

        const { queue } = this.#device;
        const { STORAGE, COPY_DST, COPY_SRC, MAP_READ } = GPUBufferUsage;
        const bytes = 4 * items * this.#program.sampleWords;
        const samples = this.#buffer(bytes, STORAGE | COPY_SRC);
        try {
            const { states, queues, settings: uniform } = this.#buffers;
            queue.writeBuffer(uniform, 0, settings);
            const resources = [uniform, ...this.#scenes[side], states, queues, samples];
            const entries = resources.map((buffer, binding) => ({ binding, resource: { buffer } }));
            const group = this.#device.createBindGroup({ layout: this.#layout, entries });
            const encoder = this.#device.createCommandEncoder();
            encoder.clearBuffer(states);
            encoder.clearBuffer(queues);
            queue.submit([encoder.finish()]);
            let left = items;
            while (left > 0) {
                left = items - (await this.#advance(group, slots, left));
                if (!isWanted()) return null;
            }
            const read = this.#buffer(bytes, MAP_READ | COPY_DST);
            const copy = this.#device.createCommandEncoder();
            copy.copyBufferToBuffer(samples, 0, read, 0, bytes);
            queue.submit([copy.finish()]);
            return await this.#read(read, true);
        } finally {
            samples.destroy();
        }
    }

    /** Rounds, and how many samples are done after them, of which so many were left: no list is longer than they allow. */
    async #advance(group, slots, left) {
        const start = performance.now();
        const { counters, listCounters, mostRounds } = this.#program;
        const encoder = this.#device.createCommandEncoder();
        for (let round = 0; round < this.#rounds; round++) {
            encoder.clearBuffer(this.#buffers.queues, 4 * listCounters[0], 4 * (listCounters[1] - listCounters[0]));
            const pass = encoder.beginComputePass();
            pass.setBindGroup(0, group);
            this.#kernels.forEach(({ pipeline, share }, kernel) => {
                pass.setPipeline(pipeline);
                pass.dispatchWorkgroups(Math.ceil((share * (kernel === 0 ? slots : Math.min(slots, left))) / 64));
            });
            pass.end();
        }
        encoder.copyBufferToBuffer(this.#buffers.queues, 0, this.#buffers.counters, 0, 4 * counters);
        this.#device.queue.submit([encoder.finish()]);
        const found = new Uint32Array((await this.#read(this.#buffers.counters, false)).buffer);
        const pace = Math.min(Math.max(PACE / (performance.now() - start), 0.25), 2);
        this.#rounds = Math.min(Math.max(Math.floor(this.#rounds * pace), 1), mostRounds);
        return found[1];
    }

    /** Takes a side's scene: of each array the number of words, then the words. */
    #take(side, words) {
        this.#scenes[side]?.forEach((buffer) => buffer.destroy());
        let at = ARRAYS;
        this.#scenes[side] = Array.from(words.subarray(0, ARRAYS), (count) => {
            const buffer = this.#buffer(4 * Math.max(count, 8), GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST);
            this.#device.queue.writeBuffer(buffer, 0, words, at, count);
            at += count;
            return buffer;
        });
    }

    /** A copy of what a buffer holds. */
    async #read(buffer, isLast) {
        await buffer.mapAsync(GPUMapMode.READ);
        const bytes = new Uint8Array(buffer.getMappedRange()).slice();
        buffer.unmap();
        if (isLast) buffer.destroy();
        return bytes;
    }

    #buffer(size, usage) {
        return this.#device.createBuffer({ size, usage });
    }
}
