use crate::GpuError;

/// Opens an adapter with WebGPU's default limits and no features.
pub(super) fn open() -> Result<(wgpu::AdapterInfo, wgpu::Device, wgpu::Queue), GpuError> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        // Through OpenGL wgpu cannot render to four f32 a sample, which WebGPU promises.
        backends: wgpu::Backends::PRIMARY,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        ..wgpu::RequestAdapterOptions::default()
    }))
    .map_err(|error| GpuError::NoAdapter(error.to_string()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        label: Some("ivg-render"),
        required_limits: wgpu::Limits::default(),
        ..wgpu::DeviceDescriptor::default()
    }))
    .map_err(|error| GpuError::Device(error.to_string()))?;
    Ok((adapter.get_info(), device, queue))
}

/// Runs `work` and turns what the device complains about into an error instead of a panic.
pub(super) fn checked<T>(
    device: &wgpu::Device,
    work: impl FnOnce() -> Result<T, GpuError>,
) -> Result<T, GpuError> {
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let result = work();
    let complaints = [validation.pop(), internal.pop(), memory.pop()].map(pollster::block_on);
    match complaints.into_iter().flatten().next() {
        Some(complaint) => Err(GpuError::Device(complaint.to_string())),
        None => result,
    }
}
