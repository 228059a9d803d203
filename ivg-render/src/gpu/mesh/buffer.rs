use wgpu::{Buffer, BufferUsages};

use crate::GpuError;

/// Bytes of a buffer that nothing has been written to.
const LEAST_BYTES: u64 = 256;

/// A buffer that grows and keeps what is in it.
#[derive(Debug)]
pub(super) struct Growing {
    label: &'static str,
    buffer: Buffer,
}

impl Growing {
    /// An empty one.
    pub(super) fn new(
        device: &wgpu::Device,
        label: &'static str,
        usage: BufferUsages,
    ) -> Result<Self, GpuError> {
        let usage = usage | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        Ok(Self { label, buffer: create(device, label, usage, LEAST_BYTES) })
    }

    /// Writes bytes at an offset; both are multiples of four.
    pub(super) fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        offset: u64,
        bytes: &[u8],
    ) -> Result<(), GpuError> {
        self.reserve(device, queue, offset + bytes.len() as u64)?;
        queue.write_buffer(&self.buffer, offset, bytes);
        Ok(())
    }

    /// Makes room for that many bytes: twice as many as there were at least, so that a mesh that grows step by step is
    /// copied a constant number of times. Copying is done by the device; nothing is uploaded again.
    fn reserve(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, needed: u64) -> Result<(), GpuError> {
        let there = self.buffer.size();
        if needed <= there {
            return Ok(());
        }
        let limits = device.limits();
        let limit = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size) & !3;
        if needed > limit {
            return Err(GpuError::Limit { what: "bytes of a progressive mesh", needed, limit });
        }
        let buffer = create(device, self.label, self.buffer.usage(), needed.max(2 * there).min(limit));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&self.buffer, 0, &buffer, 0, there);
        queue.submit([encoder.finish()]);
        self.buffer = buffer;
        Ok(())
    }

    /// All of it, to be drawn from.
    pub(super) fn slice(&self) -> wgpu::BufferSlice<'_> {
        self.buffer.slice(..)
    }

    /// All of it, to be bound.
    pub(super) fn binding(&self) -> wgpu::BindingResource<'_> {
        self.buffer.as_entire_binding()
    }
}

fn create(device: &wgpu::Device, label: &str, usage: BufferUsages, size: u64) -> Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    })
}
