#if ANTHRONET_BURST
using System;
using Unity.Burst;
using Unity.Collections;
using Unity.Collections.LowLevel.Unsafe;
using Unity.Jobs;

namespace Anthronet
{
    /// <summary>
    /// `AnthroSkin.Run` as a job of Unity's job system, compiled by Burst; available if the package com.unity.burst is
    /// installed. Everything that the jobs point to must stay valid until the job is complete.
    /// </summary>
    [BurstCompile]
    public unsafe struct AnthroSkinBurst : IJob
    {
        /// <summary>`AnthroContext.Pointer`, or zero. Jobs that may run at the same time must not share one.</summary>
        [NativeDisableUnsafePtrRestriction] public IntPtr context;
        /// <summary>The surfaces to skin.</summary>
        [ReadOnly] public NativeArray<AnthroSkinJob> jobs;
        /// <summary>One element, which receives the result of `AnthroSkin.Run`.</summary>
        [WriteOnly] public NativeArray<int> status;

        /// <summary>Skins the surfaces.</summary>
        public void Execute()
        {
            status[0] = AnthroSkin.Run(
                context, (AnthroSkinJob*)NativeArrayUnsafeUtility.GetUnsafeReadOnlyPtr(jobs), jobs.Length);
        }
    }
}
#endif
