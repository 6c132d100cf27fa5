#if ANTHRONET_BURST
using Unity.Burst;
using Unity.Collections;
using Unity.Collections.LowLevel.Unsafe;
using Unity.Jobs;

namespace Anthronet
{
    /// <summary>
    /// `AnthroSkin.Run` as a job of Unity's, compiled by Burst; there where the package com.unity.burst is. What the
    /// pointers of the jobs point to has to stay until it is complete.
    /// </summary>
    [BurstCompile]
    public unsafe struct AnthroSkinBurst : IJob
    {
        /// <summary>The surfaces.</summary>
        [ReadOnly] public NativeArray<AnthroSkinJob> jobs;
        /// <summary>One number, which becomes what `AnthroSkin.Run` says.</summary>
        [WriteOnly] public NativeArray<int> status;

        /// <summary>Poses them.</summary>
        public void Execute()
        {
            status[0] = AnthroSkin.Run(
                (AnthroSkinJob*)NativeArrayUnsafeUtility.GetUnsafeReadOnlyPtr(jobs), jobs.Length);
        }
    }
}
#endif
